"""The boat's configuration: one frozen tree, read from TOML.

Every field has a default that is safe on the lake boat; a file names only what differs. An unknown key, a
wrong type or a value out of range is a ConfigError that names the key. MAVLink parameters (`params.py`) are
rows over the same fields.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from companion.config.avoidance import AvoidanceSetting
from companion.config.estimation import Estimation
from companion.config.failsafe import Failsafe
from companion.config.fence import FenceSetting
from companion.config.handling import Handling
from companion.config.parts import Parts
from companion.config.rc import Rc
from companion.config.section import NonNegative, Positive, Section, Share, SystemId, replaced
from companion.config.thrusters import Thrusters
from companion.core.errors import ConfigError
from companion.core.toml_text import parse_toml


class LinkConfig(Section, frozen=True):
    """One link to ground stations or other vehicles. In the list of links, a url alone does as well.

    allow, deny and max_hz name messages, and hold for what leaves by the link, the boat's own and forwarded.
    """

    url: str
    name: str = ""  # for people; the far side's address where it is empty
    forward: bool = True  # False: talks with the boat alone, not with the other links
    stream_hz: NonNegative | None = None  # instead of mavlink.stream_hz
    signing: Literal["off", "accept", "required"] = "off"
    key_file: str = ""  # of mode 0600; the key that SETUP_SIGNING has brought where it is empty
    trusted: bool | None = None  # whether SETUP_SIGNING may come over it; unless said, loopback may
    local_networks: tuple[str, ...] = ()  # of udpin: nobody forges addresses there, such as 192.168.1.0/24
    radio: bool | None = None  # a slow line that reports on itself; unless said, a serial line is one
    max_bytes_s: NonNegative = 0.0  # 0: a radio's is worked out from its baud rate, others have no limit
    max_hz: dict[str, Positive] = msgspec.field(default_factory=dict)
    allow: tuple[str, ...] = ()  # nothing but these
    deny: tuple[str, ...] = ()
    stale_s: NonNegative = 0.0  # drop what has waited longer for room; 0: 1 s on a radio, else do not wait


class Identity(Section, frozen=True):
    """Who the boat is on the MAVLink network, and who its operator may be (0: any ground station).

    only_operator: nobody else may change anything, other than programs with the boat's own system id. Without
    it the operator's id decides whose silence sets off a failsafe and who may hold the sticks, no more.
    """

    system_id: SystemId = 1
    operator_system_id: Annotated[int, Meta(ge=0, le=255)] = 0
    only_operator: bool = False


class Heading(Section, frozen=True):
    """Heading PID in the paper's form, Gc = Kp (1 + 1/(Ti s) + Td s), given as Kp, Ki = Kp/Ti, Kd = Kp Td.

    Input rad, output share of full differential thrust: kp is 1/rad, ki 1/(rad s), kd s/rad. So from cruise
    speed on; at rest in the water all are slow_gain times as high, in between in proportion.
    """

    kp: NonNegative = 4.0
    ki: NonNegative = 1.0
    kd: NonNegative = 3.0
    integral_band_rad: NonNegative = 0.15  # the integral learns this near to a steady heading; 0: always
    max_steering: Share = 1.0
    slow_gain: Annotated[float, Meta(ge=0.2, le=5.0)] = 1.0  # 1: the same gains at every speed


class Speed(Section, frozen=True):
    """Speed loop: feed-forward throttle at cruise speed, then PI on the speed error."""

    cruise_m_s: Positive = 2.0
    cruise_throttle: Share = 0.6
    kp: NonNegative = 2.0  # share of full throttle per m/s
    ki: NonNegative = 0.2
    max_throttle: Share = 1.0


class MotorLimits(Section, frozen=True):
    """The gate's limits, and how long a thrust command stays good."""

    slew_per_s: Positive = 4.0  # full scale per second; reversal passes through zero
    deadband: Share = 0.0  # commands below this share are not sent: the propeller would only hum
    command_timeout_s: Positive = 0.5
    estimate_timeout_s: Positive = 3.0


class Guidance(Section, frozen=True):
    """Line of sight, corners and station keeping."""

    waypoint_radius_m: Positive = 2.0
    lookahead_m: Positive = 3.0
    accel_m_s2: Positive = 0.4  # used to slow down for a corner or the end
    corner_accel_m_s2: Positive = 0.8  # centripetal: how hard a corner may be taken
    min_speed_m_s: Positive = 0.4  # slowest speed with steerage way
    pivot_angle_rad: Annotated[float, Meta(gt=0.0, le=math.pi)] = (
        1.05  # heading error beyond which it turns on the spot
    )
    station_radius_m: Positive = 1.5


class Mission(Section, frozen=True):
    """Limits and habits of missions."""

    max_items: Annotated[int, Meta(ge=1, le=65535)] = 5000
    max_fence_items: Annotated[int, Meta(ge=1, le=65535)] = 1000
    max_rally_items: Annotated[int, Meta(ge=1, le=65535)] = 250
    rtl_speed_m_s: NonNegative = 0.0  # 0: cruise speed
    done_behave: Annotated[int, Meta(ge=0, le=1)] = 1  # after the last item: 0 HOLD, 1 LOITER, as in Rover


class Modes(Section, frozen=True):
    """Habits of the modes beyond missions: ACRO, STEERING, SIMPLE, CIRCLE, SMART_RTL, GUIDED."""

    turn_rate_rad_s: Positive = 0.8  # full stick in ACRO
    simple_type: Annotated[int, Meta(ge=0, le=1)] = 0  # the stick's "ahead": 0 as the bow was, 1 north
    circle_radius_m: Positive = 10.0
    circle_speed_m_s: NonNegative = 0.0  # 0: cruise speed
    circle_direction: Annotated[int, Meta(ge=0, le=1)] = 0  # 0 clockwise, 1 the other way
    trail_accuracy_m: Positive = 1.0  # how far the remembered track may be from the one sailed
    trail_points: Annotated[int, Meta(ge=10, le=5000)] = 500
    set_point_timeout_s: Positive = 3.0  # a velocity or attitude in GUIDED goes stale after this


class Follow(Section, frozen=True):
    """Whom FOLLOW follows, and from where."""

    system_id: Annotated[int, Meta(ge=0, le=255)] = 0  # 0: the first vehicle heard
    max_distance_m: NonNegative = 100.0  # 0: however far
    offset_type: Annotated[int, Meta(ge=0, le=1)] = 1  # 0 north and east, 1 ahead and to starboard of it
    offset_x_m: float = -10.0
    offset_y_m: float = 0.0
    gain_per_s: Positive = 0.3  # speed added for each metre behind
    timeout_s: Positive = 3.0


class Arming(Section, frozen=True):
    """What must be well before the motors may turn."""

    check: bool = True
    min_fix_type: Annotated[int, Meta(ge=0, le=6)] = 3
    max_hdop: Positive = 2.5
    battery_min_v: NonNegative = 10.5
    repeat_s: Positive = 30.0  # between two reports of what keeps the boat from arming


class BatteryPack(Section, frozen=True):
    """The pack: 3S LiPo by default."""

    capacity_mah: Positive = 2200.0
    cells: Annotated[int, Meta(ge=1, le=10)] = 3
    full_v: Positive = 12.6
    empty_v: Positive = 9.9


class Trim(Section, frozen=True):
    """What is taken out of the heading sensor's readings. Stations have it measured."""

    heading_rad: Annotated[float, Meta(ge=-math.pi, le=math.pi)] = 0.0  # added
    gyro_bias_rad_s: Annotated[float, Meta(ge=-0.2, le=0.2)] = 0.0  # subtracted


class External(Section, frozen=True):
    """Position, heading and obstacles over MAVLink: GPS_INPUT, VISION_POSITION_ESTIMATE, ODOMETRY,
    OBSTACLE_DISTANCE, DISTANCE_SENSOR.

    position, heading: 0 never, 1 while the boat's own part is silent, 2 before it. Local poses are measured
    from the origin (0, 0: as SET_GPS_GLOBAL_ORIGIN says, else where the boat's own frame lies); north_rad is
    where their x axis points, clockwise from true north.
    """

    position: Annotated[int, Meta(ge=0, le=2)] = 0
    heading: Annotated[int, Meta(ge=0, le=2)] = 0
    obstacles: bool = False
    timeout_s: Positive = 1.5  # either source is silent after this
    origin_lat_deg: Annotated[float, Meta(ge=-90.0, le=90.0)] = 0.0
    origin_lon_deg: Annotated[float, Meta(ge=-180.0, le=180.0)] = 0.0
    north_rad: Annotated[float, Meta(ge=-math.pi, le=math.pi)] = 0.0


class Mavlink(Section, frozen=True):
    """Timers of the protocol machines. They run on the boat's clock."""

    retry_s: Positive = 0.5  # what we have offered, and nobody has asked for, is offered again after this
    item_retry_s: Positive = 0.25  # a lost mission item is asked for again after this, as the guide has it
    retries: Annotated[int, Meta(ge=1)] = 10
    stream_hz: NonNegative = 4.0  # telemetry before anyone has asked for rates


class StorageSetting(Section, frozen=True):
    """Where missions and parameters live. An empty folder keeps them in memory only.

    status_file is what `boat-companion links` reads, written once a second, best on a file system in memory;
    empty: status.json in the folder.
    """

    folder: str = ""
    status_file: str = ""
    # what stations may leave in `files` altogether, in at most 1000 files and folders; 0: they may only read
    files_mb: NonNegative = 64.0


class Log(Section, frozen=True):
    """The boat's own log and the links' telemetry logs, in `logs` of the storage folder."""

    onboard: bool = True
    disarmed: bool = False  # from boot on; else from arming until after_disarm_s after disarming
    after_disarm_s: NonNegative = 10.0
    motion_hz: Annotated[float, Meta(gt=0.0, le=50.0)] = 10.0
    status_hz: Annotated[float, Meta(gt=0.0, le=50.0)] = 1.0
    quota_mb: Annotated[float, Meta(ge=1.0)] = 1000.0  # of all logs together; the oldest are removed first
    min_free_mb: NonNegative = 200.0  # no log is begun with less room on the medium
    tlog: bool = False  # every frame of every link


class BoatConfig(Section, frozen=True):
    """The whole tree."""

    links: tuple[str | LinkConfig, ...] = ()
    identity: Identity = Identity()
    heading: Heading = Heading()
    speed: Speed = Speed()
    motors: MotorLimits = MotorLimits()
    thrusters: Thrusters = Thrusters()
    guidance: Guidance = Guidance()
    handling: Handling = Handling()
    estimation: Estimation = Estimation()
    mission: Mission = Mission()
    modes: Modes = Modes()
    follow: Follow = Follow()
    failsafe: Failsafe = Failsafe()
    fence: FenceSetting = FenceSetting()
    avoidance: AvoidanceSetting = AvoidanceSetting()
    arming: Arming = Arming()
    battery: BatteryPack = BatteryPack()
    trim: Trim = Trim()
    external: External = External()
    rc: Rc = Rc()
    mavlink: Mavlink = Mavlink()
    storage: StorageSetting = StorageSetting()
    log: Log = Log()
    parts: Parts = Parts()

    @property
    def link_settings(self) -> tuple[LinkConfig, ...]:
        """The links, those that are a url alone with every other setting as it comes."""
        return tuple(LinkConfig(url=link) if isinstance(link, str) else link for link in self.links)


def decode_config(tree: Mapping[str, Any], source: str) -> BoatConfig:
    """Build the configuration from a TOML tree.

    Raises:
        ConfigError: names the source, the key and what was expected there.
    """
    try:
        return msgspec.convert(dict(tree), BoatConfig)
    except msgspec.ValidationError as error:
        raise ConfigError(f"{source}: {error}") from None


def load_config(path: Path) -> BoatConfig:
    """Read a TOML file.

    Raises:
        ConfigError: no such file, not TOML (names the line), or a key that cannot be used.
    """
    return decode_config(load_toml(path), str(path))


def load_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file into plain values.

    Raises:
        ConfigError: no such file, not UTF-8, or not TOML (names the line).
    """
    try:
        return parse_toml(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise ConfigError(f"{path}: not a TOML file: {error}") from None


def with_value(config: BoatConfig, path: str, value: object) -> BoatConfig:
    """A copy of the tree with one field replaced, such as `heading.kp` or `rc.channel_1.trim_us`.

    Raises:
        ConfigError: no such field, or a value outside its type or range.
    """
    if "." not in path:
        raise ConfigError(f"{path}: no such setting")
    try:
        return replaced(config, path.split("."), value)
    except LookupError:
        raise ConfigError(f"{path}: no such setting") from None
    except msgspec.ValidationError as error:
        raise ConfigError(f"{path}: {error}") from None
