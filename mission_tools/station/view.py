"""What a boat last said: one function per message, and the table of them.

Messages are untrusted: a value that is not finite or out of range leaves the field as it was, or None.
"""

import math
from collections.abc import Callable
from typing import Final

from companion.core.geo import LatLon, LocalFrame, position_from_e7, yaw_of_quaternion
from companion.core.modes import mode_from_number
from companion.core.status_text import one_line
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.geojson import BoatTrack
from mission_tools.station.messages import (
    Battery,
    Fix,
    Home,
    MissionState,
    Obstacles,
    Place,
    Sonar,
    Verdict,
    Vessel,
    WaterCurrent,
)
from mission_tools.station.vessels import HeardVessels
from mission_tools.station.words import say

_STATES: Final = {0: "starting", 1: "starting", 2: "calibrating", 3: "standby", 4: "active",
                  5: "critical", 6: "emergency", 7: "off"}  # fmt: skip
_FIXES: Final = {2: "2D", 3: "3D", 4: "DGPS", 5: "RTK float", 6: "RTK fixed", 7: "static", 8: "PPP"}
_PROGRESS: Final = {2: "not started", 3: "active", 4: "paused", 5: "complete"}
_UNKNOWN_16: Final = 0xFFFF
_COURSE_FROM_M_S: Final = 0.2  # below, the direction of the velocity is noise
_SUBSTITUTE: Final = 0.8  # EKF_STATUS_REPORT: from here on another source replaces the sensor
DOWN: Final = 25  # MAV_SENSOR_ROTATION_PITCH_270
_CUSTOM: Final = 100  # MAV_SENSOR_ROTATION_CUSTOM
_REORDERED_MS: Final = 500  # a restart takes longer, and begins at 0
_MOST_MODES: Final = 64
_SAILING_M_S: Final = 0.3  # a slower boat may be drifting
_DRAW_MS: Final = 60_000  # the time left follows the draw of the last minute
_FARTHEST_HOME_M: Final = 1e6
_FENCE_BIT: Final = dialect.MAV_SYS_STATUS_GEOFENCE

SHOWN: Final = (
    "mode", "armed", "state", "battery", "fix", "speed_m_s", "cruise_m_s", "heading_deg", "course_deg",
    "place", "progress", "current", "sonar", "obstacles", "vessels", "starts", "load",
)  # fmt: skip
"""The fields that a snapshot has, too."""


class View:
    """The latest values of one boat; None, or empty, until heard."""

    def __init__(self) -> None:
        self.mode: str | None = None
        self.mode_names: dict[int, str] = {}
        self.mode_count: int | None = None
        self.armed: bool | None = None
        self.state: str | None = None
        self.battery: Battery | None = None
        self.battery_left_s: float | None = None
        self._sails_from_ms: int | None = None  # by the boat's clock, since it was armed
        self.fix: Fix | None = None
        self.has_heading: bool | None = None
        self.heading_share: float | None = None
        self.speed_m_s: float | None = None
        self.heading_deg: float | None = None
        self.course_deg: float | None = None
        self.place: Place | None = None
        self.home: Place | None = None
        self.mission_total: int | None = None
        self.progress: MissionState | None = None
        self.current: WaterCurrent | None = None
        self.sonar: Sonar | None = None
        self.obstacles: Obstacles | None = None
        self.heard_vessels = HeardVessels()
        self.load: float | None = None
        self.cruise_m_s: float | None = None
        self.may_arm: bool | None = None  # the boat's own pre-arm checks
        self.battery_is_well: bool | None = None
        self.is_outside: bool | None = None
        self.track = BoatTrack()
        self.boot_ms = 0  # the boat's clock
        self.starts = 0  # how often that went back: the program began anew

    @property
    def vessels(self) -> dict[str, Vessel]:
        """Those near the boat that it hears by AIS."""
        return self.heard_vessels.now(self.boot_ms)

    def on_motion(self) -> None:
        """Note when the armed boat has begun to sail."""
        if not self.armed:
            self._sails_from_ms = None
        elif self._sails_from_ms is None and (self.speed_m_s or 0.0) >= _SAILING_M_S:
            self._sails_from_ms = self.boot_ms

    @property
    def has_sailed(self) -> bool:
        """Whether the boat's mean draw is that of sailing: at rest the charge lasts for hours."""
        return self._sails_from_ms is not None and self.boot_ms - self._sails_from_ms >= _DRAW_MS

    def compass(self) -> Verdict | None:
        """Whether the heading is good, from SYS_STATUS and EKF_STATUS_REPORT."""
        if self.has_heading is None:
            return None
        if not self.has_heading or (self.heading_share or 0.0) >= 1.0:
            return Verdict(ok=False, text=say("compass.none"))
        if (self.heading_share or 0.0) >= _SUBSTITUTE:
            return Verdict(ok=False, text=say("compass.substitute"))
        return Verdict(ok=True, text=say("compass.good"))

    def way_home(self) -> Home | None:
        """Home with distance and time, straight, at cruise speed."""
        if self.home is None:
            return None
        if self.place is None:
            return Home(place=self.home)
        away = LocalFrame(LatLon(self.place.lat, self.place.lon))
        home = away.to_local(LatLon(self.home.lat, self.home.lon))
        distance_m = math.hypot(home.north_m, home.east_m)
        if not distance_m <= _FARTHEST_HOME_M:  # outside the frame's validity; not a number fails too
            return Home(place=self.home)
        time_s = None if not self.cruise_m_s else distance_m / self.cruise_m_s
        rounded_s = None if time_s is None else round(time_s, 0)
        return Home(place=self.home, distance_m=round(distance_m, 1), time_s=rounded_s)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _direction_deg(north: float, east: float) -> float:
    return round(math.degrees(math.atan2(east, north)) % 360.0, 1)


def _place(lat_e7: int, lon_e7: int) -> Place | None:
    at = position_from_e7(lat_e7, lon_e7)
    return None if at is None else Place(lat=at.lat_deg, lon=at.lon_deg)


def on_heartbeat(view: View, message: Message) -> None:
    """Take a heartbeat: mode, armed, state."""
    number = message.custom_mode
    mode = mode_from_number(number)
    view.mode = view.mode_names.get(number) or (f"mode {number}" if mode is None else mode.name)
    view.armed = bool(message.base_mode & dialect.MAV_MODE_FLAG_SAFETY_ARMED)
    view.state = _STATES.get(message.system_status)


def on_available_mode(view: View, message: Message) -> None:
    """A name of a mode, spelled as `Mode` spells it; the boat sends one message a mode."""
    name = clean(message.mode_name).upper().replace(" ", "_")
    view.mode_count = min(message.number_modes, _MOST_MODES)
    if name and (message.custom_mode in view.mode_names or len(view.mode_names) < _MOST_MODES):
        view.mode_names[message.custom_mode] = name


def on_sys_status(view: View, message: Message) -> None:
    """Battery, load, and the boat's own verdicts."""
    voltage, current = message.voltage_battery, message.current_battery
    view.battery = Battery(
        voltage_v=None if voltage == _UNKNOWN_16 else voltage / 1e3,
        current_a=None if current < 0 else current / 100.0,
        percent=message.battery_remaining if 0 <= message.battery_remaining <= 100 else None,
        left_s=view.battery_left_s if view.has_sailed else None,
    )
    view.load = message.load / 1e3
    health, enabled = message.onboard_control_sensors_health, message.onboard_control_sensors_enabled
    view.has_heading = bool(health & dialect.MAV_SYS_STATUS_SENSOR_YAW_POSITION)
    view.may_arm = bool(health & dialect.MAV_SYS_STATUS_PREARM_CHECK)
    has_battery = enabled & dialect.MAV_SYS_STATUS_SENSOR_BATTERY
    view.battery_is_well = bool(health & dialect.MAV_SYS_STATUS_SENSOR_BATTERY) if has_battery else None
    view.is_outside = bool(enabled & _FENCE_BIT) and not health & _FENCE_BIT


def on_battery_status(view: View, message: Message) -> None:
    """The time left; 0 is unknown."""
    if message.id == 0:
        view.battery_left_s = float(message.time_remaining) if message.time_remaining > 0 else None


def on_gps_raw(view: View, message: Message) -> None:
    """Quality of the receiver's fix."""
    view.fix = Fix(
        type=_FIXES.get(message.fix_type, "none"),
        satellites=None if message.satellites_visible == 0xFF else message.satellites_visible,
        error_m=message.h_acc / 1e3 if message.h_acc else None,
    )


def on_position(view: View, message: Message) -> None:
    """Place, speed and course over ground, heading."""
    on_clock(view, message)
    place = _place(message.lat, message.lon)
    if place is None:
        return
    view.place = place
    view.track.add(place)
    north, east = message.vx / 100.0, message.vy / 100.0
    view.speed_m_s = round(math.hypot(north, east), 2)
    is_under_way = view.speed_m_s >= _COURSE_FROM_M_S
    view.course_deg = _direction_deg(north, east) if is_under_way else None
    if message.hdg < 36000:
        view.heading_deg = message.hdg / 100.0
    view.on_motion()


def on_clock(view: View, message: Message) -> None:
    """The time since the boat's program began; links may change the order of two messages."""
    if message.time_boot_ms < view.boot_ms - _REORDERED_MS:
        view.starts += 1
    elif message.time_boot_ms < view.boot_ms:
        return
    view.boot_ms = message.time_boot_ms


def on_vfr_hud(view: View, message: Message) -> None:
    """Heading and speed, of a boat without a position too."""
    if view.place is None:
        view.heading_deg = float(message.heading % 360)
        view.speed_m_s = _finite(message.groundspeed)


def on_estimate(view: View, message: Message) -> None:
    """The state of the heading, from 0 (good) to 1 (lost)."""
    view.heading_share = _finite(message.compass_variance)


def on_home(view: View, message: Message) -> None:
    """Where RTL takes the boat."""
    view.home = _place(message.latitude, message.longitude) or view.home


def on_mission_current(view: View, message: Message) -> None:
    state = _PROGRESS.get(message.mission_state)
    view.progress = None if state is None else MissionState(current=message.seq, state=state)
    view.mission_total = None if message.total == _UNKNOWN_16 else message.total


def on_vector(view: View, message: Message) -> None:
    """CURRENT: the current of the water, m/s north and east."""
    if clean(message.name) != "CURRENT":
        return
    north, east = _finite(message.x), _finite(message.y)
    if north is not None and east is not None:
        speed_m_s = math.hypot(north, east)
        view.current = WaterCurrent(speed_m_s=round(speed_m_s, 2), towards_deg=_direction_deg(north, east))


def bearing_deg(ping: Message) -> float | None:
    """Of a DISTANCE_SENSOR, from the bow, starboard positive; None if it does not look sideways."""
    if ping.orientation == _CUSTOM and all(map(math.isfinite, ping.quaternion)):
        return round(math.degrees(yaw_of_quaternion(ping.quaternion)), 1)
    return (ping.orientation * 45.0 + 180.0) % 360.0 - 180.0 if ping.orientation < 8 else None


def range_m(ping: Message) -> float | None:
    """Of a DISTANCE_SENSOR; None without an echo."""
    has_echo = ping.min_distance <= ping.current_distance <= ping.max_distance
    return ping.current_distance / 100.0 if has_echo else None


def on_distance(view: View, message: Message) -> None:
    """A ping of the ranger; the depth sounder's are left out."""
    if message.orientation == DOWN or (bearing := bearing_deg(message)) is None:
        return
    beam_deg = math.degrees(_finite(message.horizontal_fov) or 0.0)
    view.sonar = Sonar(bearing_deg=bearing, range_m=range_m(message), beam_deg=round(beam_deg, 1))


def on_obstacles(view: View, message: Message) -> None:
    """Ranges round the boat, from the bow."""
    step_deg, start_deg = _finite(message.increment_f), _finite(message.angle_offset)
    step_deg = step_deg or float(message.increment)
    if message.frame != dialect.MAV_FRAME_BODY_FRD or start_deg is None or step_deg <= 0.0:
        return
    ranges = [one / 100.0 if one <= message.max_distance else None for one in message.distances]
    view.obstacles = Obstacles(start_deg=start_deg, step_deg=step_deg, ranges_m=ranges)


def on_parameter(view: View, message: Message) -> None:
    """The cruise speed, for the time to get home."""
    if clean(message.param_id) == "CRUISE_SPEED":
        speed_m_s = _finite(message.param_value)
        view.cruise_m_s = speed_m_s if speed_m_s is not None and speed_m_s > 0.0 else None


def clean(text: object) -> str:
    """Text from the wire: up to its first zero byte, in one line, without control characters."""
    line = str(text).split("\0", 1)[0]
    return one_line(line).strip()


HANDLERS: Final[dict[int, Callable[[View, Message], None]]] = {
    dialect.MAVLINK_MSG_ID_AIS_VESSEL: lambda view, message: view.heard_vessels.ingest(message, view.boot_ms),
    dialect.MAVLINK_MSG_ID_AVAILABLE_MODES: on_available_mode,
    dialect.MAVLINK_MSG_ID_BATTERY_STATUS: on_battery_status,
    dialect.MAVLINK_MSG_ID_DEBUG_VECT: on_vector,
    dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR: on_distance,
    dialect.MAVLINK_MSG_ID_EKF_STATUS_REPORT: on_estimate,
    dialect.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: on_position,
    dialect.MAVLINK_MSG_ID_GPS_RAW_INT: on_gps_raw,
    dialect.MAVLINK_MSG_ID_HEARTBEAT: on_heartbeat,
    dialect.MAVLINK_MSG_ID_HOME_POSITION: on_home,
    dialect.MAVLINK_MSG_ID_MISSION_CURRENT: on_mission_current,
    dialect.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: on_obstacles,
    dialect.MAVLINK_MSG_ID_PARAM_VALUE: on_parameter,
    dialect.MAVLINK_MSG_ID_SYSTEM_TIME: on_clock,
    dialect.MAVLINK_MSG_ID_SYS_STATUS: on_sys_status,
    dialect.MAVLINK_MSG_ID_VFR_HUD: on_vfr_hud,
}
