"""Configuration of the camera: its video stream and the command that takes an image."""

from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import NonNegative, Section

_LONGEST_URI = 159  # VIDEO_STREAM_INFORMATION.uri, with its final zero


class CameraSetting(Section, frozen=True):
    """A camera appears as a component of its own once it has a stream or a capture command.

    capture: the program and its arguments, without a shell; "{file}" in them becomes the path of the image,
    which lies in folder.
    """

    name: Annotated[str, Meta(max_length=31)] = "Boat camera"
    vendor: Annotated[str, Meta(max_length=31)] = "mavboat"
    component: Annotated[int, Meta(ge=100, le=105)] = 100  # MAV_COMP_ID_CAMERA and the five after it
    rtsp: str = ""
    encoding: Literal["h264", "h265", ""] = "h264"
    width: Annotated[int, Meta(ge=0, le=65535)] = 1280
    height: Annotated[int, Meta(ge=0, le=65535)] = 720
    rate_hz: NonNegative = 30.0
    bitrate: Annotated[int, Meta(ge=0, le=4_000_000_000)] = 0  # bit/s; 0: unknown
    field_of_view_deg: Annotated[int, Meta(ge=0, le=360)] = 0  # horizontal; 0: unknown
    capture: tuple[str, ...] = ()
    capture_timeout_s: Annotated[float, Meta(gt=0.0, le=600.0)] = 10.0
    folder: str = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rtsp and not self.rtsp.startswith(("rtsp://", "rtspt://")):
            raise ValueError(f"rtsp = {self.rtsp!r}: expected an address that begins with rtsp://")
        if len(self.rtsp.encode()) > _LONGEST_URI:
            raise ValueError(f"rtsp: expected at most {_LONGEST_URI} bytes")
        if self.capture and not self.capture[0].startswith("/"):
            raise ValueError(f"capture[0] = {self.capture[0]!r}: expected an absolute path")
        if any("{file}" in argument for argument in self.capture) and not self.folder:
            raise ValueError('folder = "": expected the folder for "{file}" of capture')

    @property
    def is_fitted(self) -> bool:
        """Whether there is a camera."""
        return bool(self.rtsp or self.capture)
