"""Messages of the camera component, from its configuration and its images."""

import math
from collections.abc import Callable

from companion import __version__
from companion.autopilot.snapshot import Snapshot
from companion.config.payload import CameraSetting
from companion.core.geo import position_to_e7
from companion.mavlink.dialect import Message, dialect
from companion.payload.camera import Camera, Image

STREAM_ID = 1
_NAME_BYTES = 32
_ENCODINGS = {
    "": dialect.VIDEO_STREAM_ENCODING_UNKNOWN,
    "h264": dialect.VIDEO_STREAM_ENCODING_H264,
    "h265": dialect.VIDEO_STREAM_ENCODING_H265,
}
_IDLE, _BUSY, _SERIES_IDLE, _SERIES_BUSY = range(4)  # CAMERA_CAPTURE_STATUS.image_status
_STORAGE_ID = 1
_DEVICE = 0  # camera_device_id of a camera that is a component of its own

CameraMessage = Callable[[Snapshot], Message | None]


def _name(text: str) -> list[int]:
    return list(text.encode()[:_NAME_BYTES].ljust(_NAME_BYTES, b"\0"))


def _version() -> int:
    """Major in the lowest byte, then minor and patch, as CAMERA_INFORMATION has it."""
    major, minor, patch = (int(part) & 0xFF for part in __version__.split(".")[:3])
    return patch << 16 | minor << 8 | major


def camera_information(now: Snapshot) -> Message:
    """No definition file: stations then ask for settings and streams at once."""
    setting = now.config.camera
    flags = 0
    if setting.capture:
        flags |= dialect.CAMERA_CAP_FLAGS_CAPTURE_IMAGE
    if setting.rtsp:
        flags |= dialect.CAMERA_CAP_FLAGS_HAS_VIDEO_STREAM
    return dialect.MAVLink_camera_information_message(
        now.boot_ms, _name(setting.vendor), _name(setting.name), _version(), math.nan, math.nan, math.nan,
        setting.width, setting.height, 0, flags, 0, b"", 0, _DEVICE,
    )  # fmt: skip


def camera_settings(now: Snapshot) -> Message:
    """Always the mode for images; zoom and focus unknown."""
    return dialect.MAVLink_camera_settings_message(
        now.boot_ms, dialect.CAMERA_MODE_IMAGE, math.nan, math.nan, _DEVICE
    )


def storage_information(now: Snapshot) -> Message:
    """The medium of the images' folder."""
    total_mb, free_mb = _space_mb(now)
    status = dialect.STORAGE_STATUS_READY if total_mb else dialect.STORAGE_STATUS_NOT_SUPPORTED
    return dialect.MAVLink_storage_information_message(
        now.boot_ms, _STORAGE_ID, 1 if total_mb else 0, status, total_mb, total_mb - free_mb, free_mb,
        math.nan, math.nan, dialect.STORAGE_TYPE_UNKNOWN if total_mb else 0, b"", 0,
    )  # fmt: skip


def capture_status(now: Snapshot) -> Message:
    """Whether an image is being taken, and how many were."""
    camera = now.payload.camera
    return dialect.MAVLink_camera_capture_status_message(
        now.boot_ms, image_status(camera), 0, camera.interval_s if camera.has_series else 0.0, 0,
        _space_mb(now)[1], camera.count, _DEVICE,
    )  # fmt: skip


def image_status(camera: Camera) -> int:
    if camera.has_series:
        return _SERIES_BUSY if camera.is_capturing else _SERIES_IDLE
    return _BUSY if camera.is_capturing else _IDLE


def video_stream_information(now: Snapshot) -> Message | None:
    """The one stream; None without."""
    setting = now.config.camera
    if not setting.rtsp:
        return None
    return dialect.MAVLink_video_stream_information_message(
        STREAM_ID, 1, dialect.VIDEO_STREAM_TYPE_RTSP, *_stream(setting), setting.name.encode()[:31],
        setting.rtsp.encode(), _ENCODINGS[setting.encoding], _DEVICE,
    )  # fmt: skip


def video_stream_status(now: Snapshot) -> Message | None:
    """As configured: the boat does not watch the stream."""
    setting = now.config.camera
    if not setting.rtsp:
        return None
    return dialect.MAVLink_video_stream_status_message(STREAM_ID, *_stream(setting), _DEVICE)


def _stream(setting: CameraSetting) -> tuple[int, float, int, int, int, int, int]:
    """Flags, frame rate, resolution, bit rate, rotation and field of view."""
    return (
        dialect.VIDEO_STREAM_STATUS_FLAGS_RUNNING, setting.rate_hz, setting.width, setting.height,
        setting.bitrate, 0, setting.field_of_view_deg,
    )  # fmt: skip


def _space_mb(now: Snapshot) -> tuple[float, float]:
    capture = now.payload.capture
    return (0.0, 0.0) if capture is None else capture.space_mb()


def image_captured(now: Snapshot, image: Image) -> Message:
    """Index, time and place of an image, as of the shutter."""
    lat_e7, lon_e7 = (0, 0) if image.position is None else position_to_e7(image.position)
    unix_s = now.unix_s - (now.now_s - image.time_s) if now.unix_s else 0.0
    yaw_rad = 0.0 if math.isnan(image.heading_rad) else image.heading_rad
    attitude = [math.cos(0.5 * yaw_rad), 0.0, 0.0, math.sin(0.5 * yaw_rad)]
    return dialect.MAVLink_camera_image_captured_message(
        round(image.time_s * 1e3) & 0xFFFFFFFF, round(unix_s * 1e6), 0, lat_e7, lon_e7, 0, 0, attitude,
        image.index, 0 if image.fault else 1, image.path.encode()[:204],
    )  # fmt: skip


MESSAGES: dict[int, CameraMessage] = {
    dialect.MAVLINK_MSG_ID_CAMERA_INFORMATION: camera_information,
    dialect.MAVLINK_MSG_ID_CAMERA_SETTINGS: camera_settings,
    dialect.MAVLINK_MSG_ID_STORAGE_INFORMATION: storage_information,
    dialect.MAVLINK_MSG_ID_CAMERA_CAPTURE_STATUS: capture_status,
    dialect.MAVLINK_MSG_ID_VIDEO_STREAM_INFORMATION: video_stream_information,
    dialect.MAVLINK_MSG_ID_VIDEO_STREAM_STATUS: video_stream_status,
}
