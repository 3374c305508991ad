"""GUIDED set-points of position, velocity, heading and turn rate.

The protocol has no answer to set-points; a refusal is reported to its sender by status text, each reason once
in REPEAT_S.
"""

import math
from collections.abc import Callable, Container

from companion.core.geo import LatLon, Point, from_body_axes, position_from_e7, yaw_of_quaternion
from companion.core.intent import Hold, HoldCourse, HoldHeading, HoldTurn
from companion.core.requests import GoTo, SetPoint
from companion.core.state import NavState
from companion.core.status_text import Severity
from companion.core.units import wrap_pi
from companion.mavlink.dialect import Message, constants, dialect
from companion.mavlink.items import GLOBAL_FRAMES
from companion.rc.manual_input import top_speed_m_s
from companion.services.outbox import Origin
from companion.services.statustext import StatusTextService
from companion.vehicle.vehicle import Vehicle

REPEAT_S = 30.0
_MOST_REASONS = 20  # in that time, of all senders

_SHORTEST_Q = 0.5  # a quaternion has length 1; all zeros is no attitude

_NO_POSITION, _NO_VELOCITY, _NO_ACCELERATION = (
    sum(constants("POSITION_TARGET_TYPEMASK", f"{kind}X_IGNORE", f"{kind}Y_IGNORE"))
    for kind in ("", "V", "A")
)
_NO_YAW, _NO_YAW_RATE = constants("POSITION_TARGET_TYPEMASK", "YAW_IGNORE", "YAW_RATE_IGNORE")
_NO_ATTITUDE = dialect.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE
_NO_BODY_YAW_RATE = dialect.ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE
_NO_THRUST = dialect.ATTITUDE_TARGET_TYPEMASK_THROTTLE_IGNORE

_BODY_FRAMES = constants("MAV_FRAME", "BODY_NED", "BODY_OFFSET_NED", "BODY_FRD")
_LOCAL_FRAMES = (*_BODY_FRAMES, dialect.MAV_FRAME_LOCAL_NED, dialect.MAV_FRAME_LOCAL_OFFSET_NED)


class GuidedService:
    """Converts set-points to requests."""

    def __init__(self, vehicle: Vehicle, texts: StatusTextService) -> None:
        self._vehicle = vehicle
        self._texts = texts
        self._reported_s: dict[str, float] = {}  # last report by reason

    def on_global_target(self, message: Message, origin: Origin, now_s: float) -> None:
        """SET_POSITION_TARGET_GLOBAL_INT."""
        place = position_from_e7(message.lat_int, message.lon_int)
        self._on_target(message, origin, now_s, GLOBAL_FRAMES, lambda _: place)

    def on_local_target(self, message: Message, origin: Origin, now_s: float) -> None:
        """SET_POSITION_TARGET_LOCAL_NED."""
        self._on_target(message, origin, now_s, _LOCAL_FRAMES, lambda nav: self._local(message, nav))

    def on_attitude_target(self, message: Message, origin: Origin, now_s: float) -> None:
        """SET_ATTITUDE_TARGET: yaw of the quaternion or body yaw rate, thrust as a share of top speed."""
        nav, mask = self._vehicle.nav, message.type_mask
        thrust = 0.0 if mask & _NO_THRUST else message.thrust
        values = [thrust]
        if not mask & _NO_BODY_YAW_RATE:
            values.append(message.body_yaw_rate)
        elif not mask & _NO_ATTITUDE:
            values += message.q
        is_nothing = len(values) > 2 and math.hypot(*message.q) < _SHORTEST_Q
        if not all(math.isfinite(v) for v in values) or abs(thrust) > 1.0 or is_nothing:
            self._notify(origin, "a number is out of range", now_s)
            return
        speed_m_s = thrust * top_speed_m_s(self._vehicle.config.speed)
        hold: Hold
        if not mask & _NO_BODY_YAW_RATE:
            hold = HoldTurn(message.body_yaw_rate, speed_m_s)
        elif mask & _NO_ATTITUDE or nav is None:
            hold = HoldTurn(0.0, speed_m_s)
        else:
            hold = HoldHeading(yaw_of_quaternion(message.q), speed_m_s)
        self._hold(hold, origin, now_s)

    def _on_target(
        self,
        message: Message,
        origin: Origin,
        now_s: float,
        frames: Container[int],
        locate: Callable[[NavState], LatLon | None],
    ) -> None:
        """Position has priority over velocity, yaw over yaw rate; accelerations and forces are refused.

        FORCE_SET selects between the two and is irrelevant if both are ignored: many programs set all upper
        bits.
        """
        nav, mask = self._vehicle.nav, message.type_mask
        if nav is None or self._vehicle.frame is None:
            self._notify(origin, "no position yet", now_s)
        elif message.coordinate_frame not in frames:
            self._notify(origin, f"frame {message.coordinate_frame} is not supported", now_s)
        elif mask & _NO_ACCELERATION != _NO_ACCELERATION:
            self._notify(origin, "accelerations and forces are not supported", now_s)
        elif not mask & _NO_POSITION:
            self._go_to(message, locate(nav), origin, now_s)
        elif (hold := _motion(message, nav)) is None:
            self._notify(origin, "neither position nor velocity nor yaw, or not a number", now_s)
        else:
            self._hold(hold, origin, now_s)

    def _go_to(self, message: Message, position: LatLon | None, origin: Origin, now_s: float) -> None:
        """A position; an accompanying velocity gives the speed."""
        speed_m_s: float | None = None
        if not message.type_mask & _NO_VELOCITY:
            speed_m_s = math.hypot(message.vx, message.vy) or None
        if position is None or (speed_m_s is not None and not math.isfinite(speed_m_s)):
            self._notify(origin, "a number is out of range", now_s)
        elif not self._vehicle.is_guided:
            self._notify(origin, "not in GUIDED", now_s)
        elif (frame := self._vehicle.frame) and not self._vehicle.fence.allows(frame.to_local(position)):
            self._notify(origin, "outside the fence", now_s)
        else:
            self._vehicle.request(GoTo(position, speed_m_s))

    def _hold(self, hold: Hold, origin: Origin, now_s: float) -> None:
        outcome = self._vehicle.request(SetPoint(hold))
        if not outcome.accepted:
            self._notify(origin, outcome.reason, now_s)

    def _notify(self, origin: Origin, reason: str, now_s: float) -> None:
        whom = f"{origin.address.system}/{origin.address.component}"
        text = f"Set-point of {whom} ignored: {reason}"
        if now_s - self._reported_s.get(text, -math.inf) < REPEAT_S:
            return
        self._reported_s = {one: at_s for one, at_s in self._reported_s.items() if now_s - at_s < REPEAT_S}
        if len(self._reported_s) < _MOST_REASONS:
            self._reported_s[text] = now_s
            self._texts.notify(Severity.WARNING, text)

    def _local(self, message: Message, nav: NavState) -> LatLon | None:
        """LOCAL_NED is relative to the origin of the local frame, all others to the boat."""
        frame = self._vehicle.frame
        north, east = message.x, message.y
        if frame is None or not math.isfinite(north + east) or math.hypot(north, east) > 1e5:
            return None
        if message.coordinate_frame in _BODY_FRAMES:
            north, east = from_body_axes(north, east, nav.heading_rad)
        if message.coordinate_frame != dialect.MAV_FRAME_LOCAL_NED:
            north, east = north + nav.north_m, east + nav.east_m
        return frame.to_global(Point(north, east))


def _motion(message: Message, nav: NavState) -> Hold | None:
    """The motion of a set-point without a position; None if there is none or it is not finite."""
    mask, is_body = message.type_mask, message.coordinate_frame in _BODY_FRAMES
    has_velocity = not mask & _NO_VELOCITY
    north, east = (message.vx, message.vy) if has_velocity else (0.0, 0.0)
    yaw = None if mask & _NO_YAW else message.yaw
    rate = None if mask & _NO_YAW_RATE else message.yaw_rate
    if not all(math.isfinite(value) for value in (north, east, yaw or 0.0, rate or 0.0)):
        return None
    is_astern = is_body and north < 0.0
    if is_body:
        north, east = from_body_axes(north, east, nav.heading_rad)
        yaw = None if yaw is None else yaw + nav.heading_rad
    speed = math.hypot(north, east)
    if yaw is not None:  # only the velocity along the bow counts
        return HoldHeading(wrap_pi(yaw), north * math.cos(yaw) + east * math.sin(yaw))
    if rate is not None:
        return HoldTurn(rate, -speed if is_astern else speed)
    if not has_velocity:
        return None
    if speed == 0.0 or is_astern:
        return HoldTurn(0.0, -speed)
    return HoldCourse(math.atan2(east, north), speed)
