"""External position, heading and obstacles: GPS_INPUT, VISION_POSITION_ESTIMATE, ODOMETRY, OBSTACLE_DISTANCE,
DISTANCE_SENSOR, and SET_GPS_GLOBAL_ORIGIN for local poses.

The configuration enables them. One sender at a time: another is accepted once the first has been silent for
the time-out. Values that are not finite, out of range or too fast are dropped and counted.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from companion.config.boat_config import External
from companion.config.parameters import Parameters
from companion.core.geo import LatLon, LocalFrame, Point, from_body_axes, position_from_e7, yaw_of_quaternion
from companion.core.readings import GnssFix, HeadingReading, SonarReading
from companion.core.status_text import Severity
from companion.core.units import GPS_EPOCH_UNIX_S, GPS_WEEK_S, wrap_pi
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.sensors.external import ExternalSensors, Use
from companion.services.outbox import Origin, Outbox
from companion.services.statustext import StatusTextService
from companion.services.telemetry.motion_messages import global_origin
from companion.vehicle.vehicle import Vehicle

_MIN_SPACING_S = 0.015  # at most one pose per tick
_OBSTACLES_SPACING_S = 0.045
_FARTHEST_M = 20_000.0  # range of the local frame
_FASTEST_M_S = 30.0
_FASTEST_RAD_S = 10.0
_POSE_SIGMA_M = 0.05  # of a pose without stated accuracy
_UNKNOWN_SATELLITES = 255
_BEST_FIX: int = dialect.GPS_FIX_TYPE_PPP
_UNIT = (0.8, 1.2)  # accepted norm of a quaternion
_RAY_RAD = math.radians(15.0)
_UNKNOWN_CM = 0xFFFF
_LOCAL_FRAMES = (dialect.MAV_FRAME_LOCAL_NED, dialect.MAV_FRAME_LOCAL_FRD)

ToOwnClock = Callable[[Address, int, float], float]
"""Converts a sender's stamp in µs to the boat's time in s, given the present time."""


@dataclass(eq=False)
class ExternalPoseService:
    """Converts the messages to readings."""

    _external: ExternalSensors
    _vehicle: Vehicle
    _parameters: Parameters
    _outbox: Outbox
    _texts: StatusTextService
    _to_own_clock: ToOwnClock
    dropped: int = field(default=0, init=False)
    _source: Address | None = field(default=None, init=False)
    _source_s: float = field(default=-math.inf, init=False)
    _obstacles_s: float = field(default=-math.inf, init=False)

    def __post_init__(self) -> None:
        self.table: dict[int, Callable[[Message, Origin, float], None]] = {
            dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR: self._on_distance,
            dialect.MAVLINK_MSG_ID_GPS_INPUT: self._on_gps_input,
            dialect.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: self._on_obstacles,
            dialect.MAVLINK_MSG_ID_ODOMETRY: self._on_odometry,
            dialect.MAVLINK_MSG_ID_SET_GPS_GLOBAL_ORIGIN: self._on_set_origin,
            dialect.MAVLINK_MSG_ID_VISION_POSITION_ESTIMATE: self._on_vision,
        }

    @property
    def _setting(self) -> External:
        return self._parameters.config.external

    def set_origin(self, origin: LatLon) -> bool:
        """Set the origin of local poses. Refused once the boat has a frame: it would jump."""
        if self._vehicle.frame is not None:
            self._texts.notify(Severity.WARNING, "Origin: already set, not moved")
            return False
        self._external.frame = LocalFrame(origin)
        self._outbox.broadcast(global_origin(origin))
        return True

    def _on_set_origin(self, message: Message, origin: Origin, now_s: float) -> None:  # noqa: ARG002
        place = position_from_e7(message.latitude, message.longitude)
        if place is None:
            self.dropped += 1
        else:
            self.set_origin(place)

    def _on_gps_input(self, message: Message, origin: Origin, now_s: float) -> None:
        place = position_from_e7(message.lat, message.lon)
        flags = message.ignore_flags
        has_velocity = not flags & dialect.GPS_INPUT_IGNORE_FLAG_VEL_HORIZ
        north_m_s, east_m_s = (message.vn, message.ve) if has_velocity else (None, None)
        hdop = 1.0 if flags & dialect.GPS_INPUT_IGNORE_FLAG_HDOP else float(message.hdop)
        has_accuracy = not flags & dialect.GPS_INPUT_IGNORE_FLAG_HORIZONTAL_ACCURACY
        accuracy = float(message.horiz_accuracy) if has_accuracy else None
        numbers = [hdop, *(one for one in (north_m_s, east_m_s, accuracy) if one is not None)]
        is_sane = _all_below(numbers, 1000.0) and hdop >= 0.0 and (accuracy is None or accuracy >= 0.0)
        if place is None or message.fix_type > _BEST_FIX or not is_sane:
            self.dropped += 1
            return
        if not self._admits(origin.address, self._external.fix, now_s):
            return
        self._external.fix = GnssFix(
            self._to_own_clock(origin.address, message.time_usec, now_s),
            place,
            message.fix_type,
            message.satellites_visible,
            hdop,
            north_m_s,
            east_m_s,
            horizontal_accuracy_m=accuracy or None,
            unix_time_s=_unix_s(message.time_week, message.time_week_ms),
        )
        if 0 < message.yaw <= 36000:
            heading_rad = math.radians(message.yaw / 100.0)
            self._external.heading = HeadingReading(self._external.fix.time_s, wrap_pi(heading_rad))

    def _on_vision(self, message: Message, origin: Origin, now_s: float) -> None:
        yaw, turn_rad, sigma_m = float(message.yaw), self._setting.north_rad, _sigma_m(message.covariance)
        self._ingest_pose(message, message.usec, yaw, turn_rad, sigma_m, origin, now_s)

    def _on_odometry(self, message: Message, origin: Origin, now_s: float) -> None:
        yaw, frame = _yaw_of(message.q), message.frame_id
        if yaw is None or message.quality < 0 or frame not in _LOCAL_FRAMES:
            self.dropped += 1
            return
        turn_rad = self._setting.north_rad if frame == dialect.MAV_FRAME_LOCAL_FRD else 0.0
        ahead, aside, rate = float(message.vx), float(message.vy), float(message.yawspeed)
        is_body = message.child_frame_id in (dialect.MAV_FRAME_BODY_FRD, dialect.MAV_FRAME_BODY_NED)
        direction = turn_rad + (yaw if is_body else 0.0)
        is_slow = _all_below((ahead, aside), _FASTEST_M_S)
        velocity = from_body_axes(ahead, aside, direction) if is_slow else (None, None)
        sigma_m = _sigma_m(message.pose_covariance)
        rate_rad_s = rate if _all_below((rate,), _FASTEST_RAD_S) else None
        self._ingest_pose(
            message, message.time_usec, yaw, turn_rad, sigma_m, origin, now_s, velocity, rate_rad_s
        )

    def _ingest_pose(
        self,
        message: Message,
        stamp_us: int,
        yaw_rad: float,
        turn_rad: float,
        sigma_m: float,
        origin: Origin,
        now_s: float,
        velocity: tuple[float | None, float | None] = (None, None),
        rate_rad_s: float | None = None,
    ) -> None:
        """A pose in a local frame with its x axis turn_rad clockwise from north."""
        external, frame = self._external, self._external.frame
        place = Point(float(message.x), float(message.y))
        if frame is None or not _all_below(place, _FARTHEST_M) or not math.isfinite(yaw_rad):
            self.dropped += 1
            return
        if not self._admits(origin.address, external.fix, now_s):
            return
        time_s = self._to_own_clock(origin.address, stamp_us, now_s)
        external.fix = GnssFix(
            time_s,
            frame.to_global(from_body_axes(*place, turn_rad)),
            3,
            _UNKNOWN_SATELLITES,
            0.5,
            *velocity,
            horizontal_accuracy_m=sigma_m,
            reset_counter=message.reset_counter,
        )
        external.heading = HeadingReading(time_s, wrap_pi(yaw_rad + turn_rad), rate_rad_s)

    def _on_distance(self, message: Message, origin: Origin, now_s: float) -> None:  # noqa: ARG002
        bearing = _bearing_of(message)
        range_cm = message.current_distance
        if not self._setting.obstacles or bearing is None or range_cm < message.min_distance:
            self.dropped += 1
            return
        beam_rad = message.horizontal_fov if 0.0 < message.horizontal_fov <= math.pi else _RAY_RAD
        range_m = None if range_cm >= message.max_distance else range_cm / 100.0
        self._ping(now_s, bearing, range_m, message.min_distance, message.max_distance, beam_rad)

    def _on_obstacles(self, message: Message, origin: Origin, now_s: float) -> None:  # noqa: ARG002
        step_deg = message.increment_f or float(message.increment)
        offset_deg = message.angle_offset
        nav = self._vehicle.nav
        from_north = message.frame == dialect.MAV_FRAME_GLOBAL
        is_known = message.frame == dialect.MAV_FRAME_BODY_FRD or (from_north and nav is not None)
        is_sane = is_known and abs(step_deg) <= 360.0 and abs(offset_deg) <= 360.0
        if not (self._setting.obstacles and is_sane) or now_s - self._obstacles_s < _OBSTACLES_SPACING_S:
            self.dropped += 1
            return
        self._obstacles_s = now_s
        turn_rad = -nav.heading_rad if from_north and nav is not None else 0.0
        count = len(message.distances) if step_deg == 0.0 else int(360.0 / abs(step_deg))
        for number, range_cm in enumerate(message.distances[:count]):
            if range_cm == _UNKNOWN_CM:
                continue
            bearing = wrap_pi(math.radians(offset_deg + number * step_deg) + turn_rad)
            range_m = None if range_cm > message.max_distance else range_cm / 100.0
            beam_rad = math.radians(abs(step_deg))
            self._ping(now_s, bearing, range_m, message.min_distance, message.max_distance, beam_rad)

    def _ping(
        self, now_s: float, bearing: float, range_m: float | None, min_cm: int, max_cm: int, beam_rad: float
    ) -> None:
        ping = SonarReading(now_s, bearing, range_m, min_cm / 100.0, max_cm / 100.0)
        self._external.pings.append((ping, beam_rad))

    def _admits(self, sender: Address, latest: GnssFix | None, now_s: float) -> bool:
        """Whether this is the active sender, and not too fast."""
        setting = self._setting
        is_wanted = setting.position != Use.NEVER or setting.heading != Use.NEVER
        is_other = sender != self._source and now_s - self._source_s <= setting.timeout_s
        if not is_wanted or is_other or (latest is not None and now_s - self._source_s < _MIN_SPACING_S):
            self.dropped += 1
            return False
        self._source, self._source_s = sender, now_s
        return True


def _all_below(values: tuple[float, ...] | list[float], limit: float) -> bool:
    """Whether all are finite and within ±limit."""
    return all(abs(value) <= limit for value in values)


def _yaw_of(q: list[float]) -> float | None:
    """The yaw of a quaternion w, x, y, z; None if invalid."""
    return yaw_of_quaternion(q) if _UNIT[0] <= math.hypot(*q) <= _UNIT[1] else None


def _sigma_m(covariance: list[float]) -> float:
    """Accuracy of a pose from its variances of x and y; NaN if not stated."""
    variance = max(covariance[0], covariance[6])
    return math.sqrt(variance) if 1e-6 < variance < 1e4 else _POSE_SIGMA_M


def _bearing_of(message: Message) -> float | None:
    """Bearing of a ranger from the bow, clockwise; None if it points up or down, or has no signal."""
    if message.signal_quality == 1:
        return None
    if message.orientation <= dialect.MAV_SENSOR_ROTATION_YAW_315:
        return wrap_pi(message.orientation * math.pi / 4.0)
    return _yaw_of(message.quaternion) if message.orientation == dialect.MAV_SENSOR_ROTATION_CUSTOM else None


def _unix_s(week: int, week_ms: int) -> float | None:
    """Unix time; None if the week is not within 2024 to 2099."""
    if not 2295 <= week < 6260:
        return None
    return GPS_EPOCH_UNIX_S + week * GPS_WEEK_S + week_ms / 1e3
