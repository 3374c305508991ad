"""Whether the boat gets on: the thrust is high, time passes, and the way made good is nought.

Over ground two things look alike: a boat that the water carries back as fast as it sails, and one that is
held. They are told apart by the set that was known while the boat still made way: where full thrust against
that set would leave headway, the water is not to blame.
"""

import math
from enum import IntEnum

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.state import Demand, MotorCommand, NavState

STALL_S = 10.0  # without way for this long
HIGH_THROTTLE = 0.75  # of what is allowed: less, and the boat is not trying
ASKED_SHARE = 0.5  # of min_speed_m_s: who asks for less wants to stay
WAY_SHARE = 0.1  # of min_speed_m_s: made good, and less counts as nothing
ALIGNED_RAD = 0.8  # a boat that still turns is not yet trying
CURRENT_TIME_S = 20.0  # over which the set is remembered
HELD_S = 6.0  # at the shore
# Way made meanwhile, and less is none; a speed tells nothing while thrust moves the estimate alone
HELD_M = 1.0
HELD_RAD = 0.25
STEERED = 1.0  # between the commands, of 2: a boat afloat turns by that
UNMET_M_S = 0.6  # of the speed over ground that thrust and set should make


class StallVerdict(IntEnum):
    """What to think of the way that is made."""

    MAKING_WAY = 0
    NO_HEADWAY = 1  # the water is as fast as the boat
    STUCK = 2  # something holds it
    AGROUND = 3  # the shore does


class StallDetector:
    """`verdict` is the present judgement; `stalled_s` how long there has been none while trying,
    `held_s` how long the shore has held the boat.
    """

    __slots__ = (
        "_current_east_m_s",
        "_current_north_m_s",
        "_held_at",
        "_held_rad",
        "held_s",
        "stalled_s",
        "verdict",
    )

    def __init__(self) -> None:
        self.verdict = StallVerdict.MAKING_WAY
        self.stalled_s = self.held_s = 0.0
        self._held_at, self._held_rad = Point(0.0, 0.0), 0.0
        self._current_north_m_s = self._current_east_m_s = 0.0

    def reset(self) -> None:
        """Begin to judge anew; what is known of the set stays."""
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
        """Judge one tick: what guidance asked, what the motors were given, how the boat moves over ground.

        Ticks on which the boat does not try (no closed loops, little speed asked for, bow off the heading)
        neither count nor clear; way made good clears. is_at_line: the hull may touch what lies at a line.
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
        if ahead_m_s > WAY_SHARE * slow_m_s:
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
        """Whether the boat has neither gone nor turned since `held_s`."""
        if self.held_s == 0.0:
            self._held_at, self._held_rad = nav.point, nav.heading_rad
        turned_rad = abs(math.remainder(nav.heading_rad - self._held_rad, math.tau))
        return turned_rad < HELD_RAD and distance_m(self._held_at, nav.point) < HELD_M

    def _is_driven(self, command: MotorCommand, nav: NavState, config: BoatConfig) -> bool:
        """Whether steering, or thrust and set together, should move it."""
        if abs(command.left - command.right) >= STEERED:
            return True
        through_m_s = 0.5 * (command.left + command.right) * config.handling.top_speed_m_s
        c, s = math.cos(nav.heading_rad), math.sin(nav.heading_rad)
        return abs(through_m_s + self._current_north_m_s * c + self._current_east_m_s * s) > UNMET_M_S
