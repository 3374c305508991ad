"""The boat's configuration: one frozen tree, read from TOML.

Every field has a default that is safe on the lake boat; a file names only the differences. An unknown key, a
wrong type or a value out of range is a ConfigError that names the key. MAVLink parameters (`parameters.py`)
are rows over the same fields.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from companion.config import sensors, tuning
from companion.config.actuators import (
    DriveSetting,
    Handling,
    MotorsPart,
    Pca9685Part,
    RudderPart,
    Thrusters,
    Windage,
)
from companion.config.autopilot import AutopilotPart, with_autopilot
from companion.config.board import I2cBus
from companion.config.payload import CameraSetting, PayloadSetting, check_payloads
from companion.config.section import NonNegative, Positive, Section, SystemId, replaced
from companion.core.errors import ConfigError
from companion.core.toml_text import parse_toml


class Parts(Section, frozen=True):
    """The hardware of the boat. i2c_bus: of all parts that do not name another."""

    i2c_bus: I2cBus = 1
    motors: MotorsPart = MotorsPart()
    rudder: RudderPart = RudderPart()
    gnss: sensors.GnssPart = sensors.GnssPart()
    compass: sensors.CompassPart = sensors.CompassPart()
    sonar: sensors.RangerPart = sensors.RangerPart()
    lidar: sensors.LidarPart = sensors.LidarPart()
    battery: sensors.BatteryPart = sensors.BatteryPart()
    hull: sensors.HullPart = sensors.HullPart()
    depth: sensors.DepthPart = sensors.DepthPart()
    ais: sensors.AisPart = sensors.AisPart()
    pca9685: Pca9685Part = Pca9685Part()
    autopilot: str | AutopilotPart = ""

    @property
    def autopilot_part(self) -> AutopilotPart:
        """The autopilot; a plain url has default settings, without a url there is none."""
        return AutopilotPart(url=self.autopilot) if isinstance(self.autopilot, str) else self.autopilot


class LinkConfig(Section, frozen=True):
    """One link to ground stations or other vehicles. In the list of links a plain url is enough.

    allow, deny and max_hz name messages and apply to outgoing ones, the boat's own and forwarded.
    """

    url: str
    name: str = ""  # display name; the address of the far side if empty
    forward: bool = True  # False: no forwarding between this and other links
    stream_hz: NonNegative | None = None  # default rate of telemetry
    signing: Literal["off", "accept", "required"] = "off"
    key_file: str = ""  # with mode 0600; if empty, the key set by SETUP_SIGNING
    trusted: bool | None = None  # whether SETUP_SIGNING is accepted; default: on loopback only
    local_networks: tuple[str, ...] = ()  # for udpin: without forged addresses, such as 192.168.1.0/24
    radio: bool | None = None  # a slow line that reports its status; default: serial lines
    max_bytes_s: NonNegative = 0.0  # 0: derived from a radio's baud rate, otherwise unlimited
    max_hz: dict[str, Positive] = msgspec.field(default_factory=dict)
    allow: tuple[str, ...] = ()  # only these
    deny: tuple[str, ...] = ()
    stale_s: NonNegative = 0.0  # drop what has waited longer; 0: 1 s


class Identity(Section, frozen=True):
    """MAVLink ids of the boat and of its operator (0: any ground station).

    only_operator: others may change nothing, except programs with the boat's own system id. Without it the
    operator's id only selects whose silence triggers a failsafe and who may steer manually.
    """

    system_id: SystemId = 1  # 0: the first vehicle heard
    operator_system_id: Annotated[int, Meta(ge=0, le=255)] = 0
    only_operator: bool = False


class Mission(Section, frozen=True):
    """Limits and options of missions."""

    max_items: Annotated[int, Meta(ge=1, le=65535)] = 5000
    max_fence_items: Annotated[int, Meta(ge=1, le=65535)] = 1000
    max_rally_items: Annotated[int, Meta(ge=1, le=65535)] = 250
    rtl_speed_m_s: NonNegative = 0.0  # 0: cruise speed
    done_behave: Annotated[int, Meta(ge=0, le=1)] = 1  # after the last item: 0 HOLD, 1 LOITER, as in Rover
    absent_payload: Literal["refuse", "skip"] = "refuse"  # an item for a payload that is not fitted


class Modes(Section, frozen=True):
    """Options of ACRO, STEERING, SIMPLE, CIRCLE, SMART_RTL and GUIDED."""

    turn_rate_rad_s: Positive = 0.8  # full stick in ACRO
    simple_type: Annotated[int, Meta(ge=0, le=1)] = 0  # direction of "ahead": 0 the initial heading, 1 north
    circle_radius_m: Positive = 10.0
    circle_speed_m_s: NonNegative = 0.0  # 0: cruise speed
    circle_direction: Annotated[int, Meta(ge=0, le=1)] = 0  # 0 clockwise, 1 counter-clockwise
    trail_accuracy_m: Positive = 1.0  # largest deviation of the recorded track
    trail_points: Annotated[int, Meta(ge=10, le=5000)] = 500
    set_point_timeout_s: Positive = 3.0  # lifetime of a velocity or attitude in GUIDED


class Follow(Section, frozen=True):
    """Target and offset of FOLLOW."""

    system_id: Annotated[int, Meta(ge=0, le=255)] = 0  # 0: the first vehicle heard
    max_distance_m: NonNegative = 100.0  # 0: no limit
    offset_type: Annotated[int, Meta(ge=0, le=1)] = 1  # 0 north and east, 1 ahead and to starboard of it
    offset_x_m: float = -10.0
    offset_y_m: float = 0.0
    gain_per_s: Positive = 0.3  # speed per metre of distance behind
    timeout_s: Positive = 3.0  # of either source


class Arming(Section, frozen=True):
    """What is checked before arming."""

    check: bool = True
    min_fix_type: Annotated[int, Meta(ge=0, le=6)] = 3
    max_hdop: Positive = 2.5
    battery_min_v: NonNegative = 10.5
    repeat_s: Positive = 30.0  # between two PreArm reports


class BatteryPack(Section, frozen=True):
    """The battery pack: 3S LiPo by default.

    cruise_a, idle_a and draw are for the planner's budget; the boat itself measures what it draws. draw:
    pairs of speed through still water in m/s and current in A, slowest first, electronics included; the last
    one at full throttle. Raises ValueError: a pair that is not faster, or does not draw more, than the one
    before.
    """

    capacity_mah: Positive = 2200.0
    cells: Annotated[int, Meta(ge=1, le=10)] = 3
    cruise_a: NonNegative = 0.0  # at cruise speed in still water, electronics included; 0: not known
    idle_a: NonNegative = 0.0  # with the motors stopped
    draw: tuple[tuple[Positive, Positive], ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        slower, less = 0.0, self.idle_a
        for speed_m_s, drawn_a in self.draw:
            if not (slower < speed_m_s < math.inf and less < drawn_a < math.inf):
                raise ValueError(
                    f"draw: [{speed_m_s:g}, {drawn_a:g}]: expected more than {slower:g} m/s and {less:g} A: "
                    "pairs of speed and current, slowest first, all above idle_a"
                )
            slower, less = speed_m_s, drawn_a


class Trim(Section, frozen=True):
    """Corrections of the heading sensor, set by calibration."""

    heading_rad: Annotated[float, Meta(ge=-math.pi, le=math.pi)] = 0.0  # added
    gyro_bias_rad_s: Annotated[float, Meta(ge=-0.2, le=0.2)] = 0.0  # subtracted


class External(Section, frozen=True):
    """Position, heading and obstacles over MAVLink: GPS_INPUT, VISION_POSITION_ESTIMATE, ODOMETRY,
    OBSTACLE_DISTANCE, DISTANCE_SENSOR.

    position, heading: 0 never, 1 while the boat's own sensor is silent, 2 preferred. Local poses are relative
    to the origin (0, 0: as set by SET_GPS_GLOBAL_ORIGIN, else the origin of the boat's frame); north_rad is
    the direction of their x axis, clockwise from true north.
    """

    position: Annotated[int, Meta(ge=0, le=2)] = 0
    heading: Annotated[int, Meta(ge=0, le=2)] = 0
    obstacles: bool = False
    timeout_s: Positive = 1.5  # either source is silent after this
    origin_lat_deg: Annotated[float, Meta(ge=-90.0, le=90.0)] = 0.0
    origin_lon_deg: Annotated[float, Meta(ge=-180.0, le=180.0)] = 0.0
    north_rad: Annotated[float, Meta(ge=-math.pi, le=math.pi)] = 0.0


class Mavlink(Section, frozen=True):
    """Timers of the protocol machines, on the boat's clock."""

    retry_s: Positive = 0.5  # period of retransmission; for mission items the shortest
    retries: Annotated[int, Meta(ge=1)] = 10
    stream_hz: NonNegative = 4.0  # telemetry before anyone has asked for rates


class StorageSetting(Section, frozen=True):
    """Where missions and parameters are stored. An empty folder keeps them in memory only.

    status_file is read by `boat-companion links`; it is written once a second, best on a file system in
    memory. Empty: status.json in the runtime directory of the boat's unit, without a unit in the folder.
    """

    folder: str = ""
    status_file: str = ""
    files_mb: NonNegative = 64.0  # for stations, in at most 1000 files and folders; 0: read only


class Log(Section, frozen=True):
    """The onboard log and the telemetry logs, in `logs` of the storage folder."""

    onboard: bool = True
    disarmed: bool = False  # log from boot; otherwise from arming until after_disarm_s after disarming
    after_disarm_s: NonNegative = 10.0
    motion_hz: Annotated[float, Meta(gt=0.0, le=50.0)] = 10.0
    status_hz: Annotated[float, Meta(gt=0.0, le=50.0)] = 1.0
    quota_mb: Annotated[float, Meta(ge=1.0)] = 1000.0  # of all logs; the oldest are removed first
    min_free_mb: NonNegative = 200.0  # required free space to begin a log
    tlog: bool = False  # all frames of all links


class BoatConfig(Section, frozen=True):
    """The whole tree of the boat's configuration."""

    links: tuple[str | LinkConfig, ...] = ()
    identity: Identity = Identity()
    heading: tuning.Heading = tuning.Heading()
    speed: tuning.Speed = tuning.Speed()
    motors: tuning.MotorLimits = tuning.MotorLimits()
    drive: DriveSetting = DriveSetting()
    thrusters: Thrusters = Thrusters()
    guidance: tuning.Guidance = tuning.Guidance()
    handling: Handling = Handling()
    windage: Windage = Windage()
    estimation: tuning.Estimation = tuning.Estimation()
    mission: Mission = Mission()
    modes: Modes = Modes()
    follow: Follow = Follow()
    failsafe: tuning.Failsafe = tuning.Failsafe()
    fence: tuning.FenceSetting = tuning.FenceSetting()
    avoidance: tuning.AvoidanceSetting = tuning.AvoidanceSetting()
    arming: Arming = Arming()
    battery: BatteryPack = BatteryPack()
    trim: Trim = Trim()
    external: External = External()
    rc: tuning.Rc = tuning.Rc()
    mavlink: Mavlink = Mavlink()
    storage: StorageSetting = StorageSetting()
    log: Log = Log()
    parts: Parts = Parts()
    payload: tuple[PayloadSetting, ...] = ()
    probe: tuple[sensors.ProbePart, ...] = ()
    camera: CameraSetting = CameraSetting()

    def __post_init__(self) -> None:
        super().__post_init__()
        check_payloads(self.payload)
        sensors.check_probes(self.probe)

    @property
    def link_settings(self) -> tuple[LinkConfig, ...]:
        """The links; a plain url has default settings."""
        return tuple(LinkConfig(url=link) if isinstance(link, str) else link for link in self.links)

    @property
    def components(self) -> tuple[int, ...]:
        """Component ids of the boat besides its own: the camera's, and a routed autopilot's."""
        autopilot = self.parts.autopilot_part.component
        camera = (self.camera.component,) if self.camera.is_fitted else ()
        return (*camera, autopilot) if autopilot else camera


def decode_config(tree: Mapping[str, Any], source: str) -> BoatConfig:
    """The configuration of a TOML tree. A ConfigError names the source, the key and the expected value."""
    try:
        return msgspec.convert(with_autopilot(_with_bus(tree)), BoatConfig)
    except msgspec.ValidationError as error:
        raise ConfigError(f"{source}: {error}") from None


def _with_bus(tree: Mapping[str, Any]) -> dict[str, Any]:
    """The tree with parts.i2c_bus in each part on I²C that names no other."""
    parts, probes = tree.get("parts"), tree.get("probe", ())
    if not isinstance(parts, dict) or "i2c_bus" not in parts:
        return dict(tree)

    def on_bus(part: object) -> object:
        return {"i2c_bus": parts["i2c_bus"], **part} if isinstance(part, dict) else part

    spread = {name: on_bus(parts.get(name, {})) for name in ("compass", "battery", "pca9685")}
    is_list = isinstance(probes, list | tuple)
    return {
        **tree,
        "parts": {**parts, **spread},
        "probe": [on_bus(one) for one in probes] if is_list else probes,
    }


def load_config(path: Path) -> BoatConfig:
    """Read a TOML file. Raises ConfigError, as `load_toml` and `decode_config`."""
    return decode_config(load_toml(path), str(path))


def load_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file into plain values. ConfigError: no such file, not UTF-8, or not TOML, and where."""
    try:
        return parse_toml(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise ConfigError(f"{path}: not a TOML file: {error}") from None


def with_value(config: BoatConfig, path: str, value: object) -> BoatConfig:
    """A copy of the tree with one field replaced, such as `heading.kp` or `rc.channel_1.trim_us`. Raises
    ConfigError if there is no such field, or the value is outside its type or range.
    """
    if "." not in path:
        raise ConfigError(f"{path}: no such setting")
    try:
        return replaced(config, path.split("."), value)
    except LookupError:
        raise ConfigError(f"{path}: no such setting") from None
    except msgspec.ValidationError as error:
        raise ConfigError(f"{path}: {error}") from None
