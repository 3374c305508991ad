"""Detects that the boat makes no headway at high thrust.

Two causes look alike over ground: a current as fast as the boat, and an obstruction. The current known while
the boat still made way separates them: if full thrust against it would leave headway, the boat is obstructed.
"""

import math
from enum import IntEnum

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.state import Demand, MotorCommand, NavState

STALL_S = 10.0  # without headway for this long
HIGH_THROTTLE = 0.75  # of the maximum: with less the boat is not trying
ASKED_SHARE = 0.5  # of min_speed_m_s: a lower demand is no attempt to move
WAY_SHARE = 0.1  # of min_speed_m_s: less is no headway
# One motor has no motor watch (failsafe/motors/watch.py), and where it gives no thrust, the
# estimator believes in some: 0.1 to 0.2 m/s. It makes headway from this share on, averaged over this time.
ONE_MOTOR_SHARE = 0.6
ONE_MOTOR_S = 4.0
ALIGNED_RAD = 0.8  # a boat that still turns is not yet trying
CURRENT_TIME_S = 20.0  # averaging time of the current
HELD_S = 6.0  # at the shore
# Least motion meanwhile; the estimated speed is unreliable, as thrust drives it
HELD_M = 1.0
HELD_RAD = 0.25
STEERED = 1.0  # difference of the commands, of 2: it turns a floating boat
UNMET_M_S = 0.6  # expected speed over ground from thrust and current


class StallVerdict(IntEnum):
    """Result of the detector."""

    MAKING_WAY = 0
    NO_HEADWAY = 1  # the current is as fast as the boat
    STUCK = 2  # an obstruction
    AGROUND = 3  # against the shore


class StallDetector:
    """`verdict`: present result; `stalled_s`: time without headway while trying; `held_s`: time held at the
    shore.
    """

    def __init__(self) -> None:
        self.verdict = StallVerdict.MAKING_WAY
        self.stalled_s = self.held_s = 0.0
        self._held_at, self._held_rad = Point(0.0, 0.0), 0.0
        self._current_north_m_s = self._current_east_m_s = self._ahead_m_s = 0.0

    def reset(self) -> None:
        """Restart the detection; the current is kept."""
        self.verdict, self.stalled_s = StallVerdict.MAKING_WAY, 0.0

    def update(
        self,
        demand: Demand | None,
        command: MotorCommand,
        nav: NavState | None,
        config: BoatConfig,
        dt_s: float,
        *,
        is_at_line: bool = False,
    ) -> StallVerdict:
        """Evaluate one tick: demand, motor command and motion over ground.

        Ticks without an attempt (open loops, low demand, bow off the heading) are ignored; headway resets the
        time. is_at_line: the hull may touch a shore.
        """
        if demand is None or nav is None:
            self.held_s = 0.0
            self.reset()
            return self.verdict
        if is_at_line and self._is_in_place(nav):
            is_driven = self._is_driven(command, nav, config)
            self.held_s = self.held_s + dt_s if is_driven else max(self.held_s - dt_s, 0.0)
            if self.held_s >= HELD_S:
                self.verdict = StallVerdict.AGROUND
                return self.verdict
        else:
            self.held_s = 0.0
        slow_m_s = config.guidance.min_speed_m_s
        c, s = math.cos(demand.heading_rad), math.sin(demand.heading_rad)
        ahead_m_s = nav.north_m_s * c + nav.east_m_s * s
        least_m_s = WAY_SHARE * slow_m_s
        if not config.drive.has_pair:
            self._ahead_m_s += min(dt_s / ONE_MOTOR_S, 1.0) * (ahead_m_s - self._ahead_m_s)
            ahead_m_s, least_m_s = self._ahead_m_s, ONE_MOTOR_SHARE * slow_m_s
        if ahead_m_s > least_m_s:
            share = dt_s / CURRENT_TIME_S
            self._current_north_m_s += share * (nav.current_north_m_s - self._current_north_m_s)
            self._current_east_m_s += share * (nav.current_east_m_s - self._current_east_m_s)
            self.reset()
            return self.verdict
        throttle = 0.5 * (command.left + command.right)
        is_trying = (
            demand.speed_m_s >= ASKED_SHARE * slow_m_s
            and throttle >= HIGH_THROTTLE * config.speed.max_throttle
            and abs(math.remainder(demand.heading_rad - nav.heading_rad, math.tau)) <= ALIGNED_RAD
        )
        if is_trying:
            self.stalled_s += dt_s
            if self.stalled_s >= STALL_S and self.verdict is StallVerdict.MAKING_WAY:
                through_m_s = throttle * config.handling.top_speed_m_s
                left_m_s = through_m_s + self._current_north_m_s * c + self._current_east_m_s * s
                self.verdict = StallVerdict.STUCK if left_m_s > slow_m_s else StallVerdict.NO_HEADWAY
        return self.verdict

    def _is_in_place(self, nav: NavState) -> bool:
        """Whether the boat has neither moved nor turned during `held_s`."""
        if self.held_s == 0.0:
            self._held_at, self._held_rad = nav.point, nav.heading_rad
        turned_rad = abs(math.remainder(nav.heading_rad - self._held_rad, math.tau))
        return turned_rad < HELD_RAD and distance_m(self._held_at, nav.point) < HELD_M

    def _is_driven(self, command: MotorCommand, nav: NavState, config: BoatConfig) -> bool:
        """Whether steering, or thrust plus current, should move the boat."""
        if abs(command.left - command.right) >= STEERED:
            return True
        through_m_s = 0.5 * (command.left + command.right) * config.handling.top_speed_m_s
        c, s = math.cos(nav.heading_rad), math.sin(nav.heading_rad)
        return abs(through_m_s + self._current_north_m_s * c + self._current_east_m_s * s) > UNMET_M_S
