"""Steering from a ground station: the control loops of the paper, closed over telemetry.

Both laws steer to the next waypoint and switch to the one after it when it is within the acceptance radius or
abeam; the goal must be reached within the radius.
"""

import math
from collections.abc import Sequence
from typing import Protocol

from companion.core.geo import Line, Point, bearing_rad, distance_m
from companion.core.modes import Mode
from companion.core.units import wrap_pi
from companion.mavlink.dialect import Message, dialect
from companion.rc.manual_input import top_speed_m_s
from mission_tools.station.wire import command_long
from sitl.run.station import Station
from sitl.world.scenario import Scenario

SAMPLE_S = 0.2
DEAD_ZONE_RAD = math.radians(15.0)
AHEAD_RAD = math.radians(30.0)  # the paper's reference [10], and so is the throttle
AHEAD_THROTTLE = 0.6
_STICK = 1000.0


class SteeringLaw(Protocol):
    """Turns a bearing into a message to the boat."""

    mode: Mode

    def order(self, aim_rad: float, heading_rad: float) -> Message:
        """The message for a bearing to the next waypoint and the heading."""


class OnOff:
    """Full turn outside the dead zone, straight ahead inside, at cruise throttle."""

    mode = Mode.MANUAL

    def __init__(self, scenario: Scenario) -> None:
        self._throttle = round(_STICK * scenario.vehicle.speed.cruise_throttle)
        self._boat = scenario.vehicle.identity.system_id

    def order(self, aim_rad: float, heading_rad: float) -> Message:
        """MANUAL_CONTROL."""
        error = wrap_pi(aim_rad - heading_rad)
        turn = 0 if abs(error) <= DEAD_ZONE_RAD else round(math.copysign(_STICK, error))
        message: Message = dialect.MAVLink_manual_control_message(self._boat, 0, turn, self._throttle, 0, 0)
        return message


class HeadingPid:
    """The boat's own heading PID, commanded to the bearing."""

    mode = Mode.GUIDED

    def __init__(self, scenario: Scenario) -> None:
        speed = scenario.vehicle.speed
        self._thrust = speed.cruise_m_s / top_speed_m_s(speed)
        self._boat = scenario.vehicle.identity.system_id

    def order(self, aim_rad: float, heading_rad: float) -> Message:  # noqa: ARG002
        """SET_ATTITUDE_TARGET: a yaw, and thrust as a share of top speed."""
        q = [math.cos(0.5 * aim_rad), 0.0, 0.0, math.sin(0.5 * aim_rad)]
        rates = (
            dialect.ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
            | dialect.ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
            | dialect.ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE
        )
        message: Message = dialect.MAVLink_set_attitude_target_message(
            0, self._boat, 1, rates, q, 0.0, 0.0, 0.0, self._thrust
        )
        return message


class HeadingPidAhead(HeadingPid):
    """The same PID at 60 % throttle, but without way on while the bearing is more than 30° off.

    After the paper's reference [10], which steers by PID within 30° and does not say what it does outside.
    """

    def __init__(self, scenario: Scenario) -> None:
        super().__init__(scenario)
        self._ahead = self._thrust * AHEAD_THROTTLE / scenario.vehicle.speed.cruise_throttle

    def order(self, aim_rad: float, heading_rad: float) -> Message:
        """SET_ATTITUDE_TARGET: a yaw, and thrust only where the bearing is ahead."""
        is_ahead = abs(wrap_pi(aim_rad - heading_rad)) <= AHEAD_RAD
        self._thrust = self._ahead if is_ahead else 0.0
        return super().order(aim_rad, heading_rad)


class ShoreSteering:
    """Follows a plan by a steering law."""

    def __init__(self, station: Station, law: SteeringLaw, plan: Sequence[Point], radius_m: float) -> None:
        """plan: start, waypoints and goal, in the boat's local frame."""
        station.listen_to(dialect.MAVLINK_MSG_ID_LOCAL_POSITION_NED, dialect.MAVLINK_MSG_ID_ATTITUDE)
        interval_us = 1e6 * SAMPLE_S
        for message_id in (dialect.MAVLINK_MSG_ID_LOCAL_POSITION_NED, dialect.MAVLINK_MSG_ID_ATTITUDE):
            number = dialect.MAV_CMD_SET_MESSAGE_INTERVAL
            station.send(command_long(station.boat, number, message_id, interval_us))
        self._next = 1
        self._station = station
        self._law = law
        self._plan = tuple(plan)
        self._radius_m = radius_m
        self._next_s = -math.inf

    @property
    def has_telemetry(self) -> bool:
        """Whether position and heading were received."""
        return "LOCAL_POSITION_NED" in self._station.latest and "ATTITUDE" in self._station.latest

    @property
    def has_arrived(self) -> bool:
        """Whether the last waypoint is reached."""
        return self._next == len(self._plan)

    def step(self, now_s: float) -> None:
        """Send the next command when it is due."""
        latest = self._station.latest
        if now_s < self._next_s or self.has_arrived or not self.has_telemetry:
            return
        position, attitude = latest["LOCAL_POSITION_NED"], latest["ATTITUDE"]
        self._next_s = now_s + SAMPLE_S - 1e-6
        here = Point(position.x, position.y)
        while self._next < len(self._plan) and self._is_reached(here):
            self._next += 1
        if self._next < len(self._plan):
            self._station.send(self._law.order(bearing_rad(here, self._plan[self._next]), attitude.yaw))

    def _is_reached(self, here: Point) -> bool:
        before, aim = self._plan[self._next - 1], self._plan[self._next]
        if distance_m(here, aim) <= self._radius_m:
            return True
        leg = Line(before, aim)
        is_goal = self._next == len(self._plan) - 1
        return not is_goal and leg.along_and_cross_track_m(here)[0] >= leg.length_m
