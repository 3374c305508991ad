"""Configuration of the payload: `[[payload]]` tables, told apart by their `kind`, and the camera.

Numbers are ArduPilot's: servo channels from 1, relays from 0; lights and horns count as relays. A safe state
is what a payload does when the program starts, the boat disarms, the operator is lost, or the program ends;
"keep" changes nothing.
"""

from collections.abc import Iterable
from typing import Annotated, Literal

from msgspec import Meta

from companion.config.actuators import PulseOutputSetting
from companion.config.actuators import PulseWidth as Width
from companion.config.board import PULLED_UP, Pin
from companion.config.section import NonNegative, Positive, Section

Number = Annotated[int, Meta(ge=1, le=6)]  # MAVLink's instances of grippers and winches
Switch = Literal["on", "off", "keep"]

FIRST_FREE_SERVO = 5  # 1 to 4 belong to motors and rudder


class _Payload(Section, frozen=True, kw_only=True, tag_field="kind"):
    """name: in messages; otherwise the kind with its number."""

    number: int
    name: str = ""

    @property
    def kind(self) -> str:
        """The kind of the table, such as servo."""
        return str(self.__struct_config__.tag)

    @property
    def title(self) -> str:
        """Its kind, number and name, for messages."""
        known_as = f"{self.kind} {self.number}"
        return f"{known_as} ({self.name})" if self.name else known_as

    @property
    def pins(self) -> dict[str, int]:
        return {
            name: pin
            for name in ("pin", "out_pin", "in_pin", "count_pin")
            if (pin := getattr(self, name, None)) is not None
        }

    @property
    def signal_in_use(self) -> PulseOutputSetting | None:
        """Its servo signal; None where it has pins instead, or no output."""
        has_pins = any(getattr(self, name, None) is not None for name in ("pin", "out_pin"))
        return None if has_pins else getattr(self, "signal", None)


class RelayPayload(_Payload, frozen=True, kw_only=True, tag="relay"):
    """A pin that switches something. max_on_s: longest time on without a break; 0: no limit.

    At the end of the program it is off, and the pin becomes an input.
    """

    number: Annotated[int, Meta(ge=0, le=15)]
    pin: Pin
    active_low: bool = False
    max_on_s: NonNegative = 0.0
    start: Literal["on", "off"] = "off"
    on_disarm: Switch = "keep"
    on_link_loss: Switch = "keep"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.active_low:
            _check_reset(pin=self.pin)


class LightPayload(RelayPayload, frozen=True, kw_only=True, tag="light"):
    """A light: a relay that also obeys ILLUMINATOR_ON_OFF."""


class HornPayload(RelayPayload, frozen=True, kw_only=True, tag="horn"):
    """A horn: a relay that does not stay on."""

    max_on_s: Annotated[float, Meta(gt=0.0, le=60.0)] = 5.0
    on_disarm: Switch = "off"
    on_link_loss: Switch = "off"


class ServoPayload(_Payload, frozen=True, kw_only=True, tag="servo"):
    """A servo channel, within the limits of its signal. "off": no pulses, so that the servo is limp."""

    number: Annotated[int, Meta(ge=FIRST_FREE_SERVO, le=16)]
    signal: PulseOutputSetting = PulseOutputSetting()
    start: Literal["off"] | Width = "off"
    on_disarm: Literal["off", "keep"] | Width = "keep"
    on_link_loss: Literal["off", "keep"] | Width = "keep"
    at_end: Literal["off"] | Width = "off"

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_widths(self, self.signal, "start", "on_disarm", "on_link_loss", "at_end")


class GripperPayload(_Payload, frozen=True, kw_only=True, tag="gripper"):
    """A gripper: a pin that is on while it is closed, or without one a servo."""

    number: Number = 1
    pin: Pin | None = None
    signal: PulseOutputSetting = PulseOutputSetting()
    active_low: bool = False
    open_us: Width = 1900
    closed_us: Width = 1100
    start: Literal["open", "closed", "keep"] = "keep"  # keep: no signal until the first command
    on_disarm: Literal["open", "closed", "keep"] = "keep"
    on_link_loss: Literal["open", "closed", "keep"] = "keep"

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_widths(self, self.signal, "open_us", "closed_us")


class WinchPayload(_Payload, frozen=True, kw_only=True, tag="winch"):
    """A winch: the two inputs of a bridge, or without them a servo for continuous rotation, whose max_us is
    full speed out. All safe states stop it.

    The line is measured by time, or by the pulses of a switch on count_pin.
    """

    number: Number = 1
    out_pin: Pin | None = None
    in_pin: Pin | None = None
    signal: PulseOutputSetting = PulseOutputSetting()
    line_m: Positive = 10.0  # the whole line
    speed_m_s: Positive = 0.2  # of the line at full speed
    count_pin: Pin | None = None
    pulse_m: Positive = 0.1  # line for each pulse
    stall_s: Positive = 3.0  # without a pulse: stop

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.out_pin is None) is not (self.in_pin is None):
            raise ValueError("expected both out_pin and in_pin, or neither")
        _check_reset(out_pin=self.out_pin, in_pin=self.in_pin)


class CommandPayload(_Payload, frozen=True, kw_only=True, tag="command"):
    """A program of the owner's, started by DO_SEND_SCRIPT_MESSAGE, or by switching `relay` on.

    run: the program and its arguments, without a shell.
    """

    number: Annotated[int, Meta(ge=0, le=65535)]
    run: Annotated[tuple[str, ...], Meta(min_length=1)]
    timeout_s: Annotated[float, Meta(gt=0.0, le=86400.0)] = 60.0
    folder: str = ""  # its working directory; otherwise the boat's
    relay: Annotated[int, Meta(ge=0, le=15)] | None = None  # for stations whose editor lacks the item

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.run[0].startswith("/"):
            raise ValueError(f"run[0] = {self.run[0]!r}: expected an absolute path")


def _check_reset(**pins: int | None) -> None:
    for key, pin in pins.items():
        if pin is not None and pin in PULLED_UP:
            raise ValueError(f"{key} = {pin}: GPIO 0 to 8 are on at reset; expected 9 to 27")


def _check_widths(setting: _Payload, signal: PulseOutputSetting, *keys: str) -> None:
    for key in keys:
        width_us = getattr(setting, key)
        if isinstance(width_us, int) and not signal.min_us <= width_us <= signal.max_us:
            raise ValueError(f"{key} = {width_us}: expected {signal.min_us} to {signal.max_us}, as in signal")


PayloadSetting = (
    RelayPayload | LightPayload | HornPayload | ServoPayload | GripperPayload | WinchPayload | CommandPayload
)


def check_payloads(payloads: Iterable[PayloadSetting]) -> None:
    """No two with one number. A ValueError names the table and the key."""
    numbers: dict[tuple[str, int], str] = {}
    for index, one in enumerate(payloads):
        key = f"payload[{index}]"
        group = "relay" if isinstance(one, RelayPayload) else one.kind
        names = [(group, "number", one.number)]
        if isinstance(one, CommandPayload) and one.relay is not None:
            names.append(("relay", "relay", one.relay))
        for kind, name, number in names:
            if (other := numbers.setdefault((kind, number), key)) != key:
                raise ValueError(f"{key}.{name} = {number}: expected another than {other}")


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
        return bool(self.rtsp or self.capture)
