"""Whether the boat gets on: the thrust is high, time passes, and the way made good is nought.

Over ground two things look alike: a boat that the water carries back as fast as it sails, and one that is
held. They are told apart by the set that was known while the boat still made way: where full thrust against
that set would leave headway, the water is not to blame.
"""

import math
from enum import IntEnum

from companion.config import BoatConfig
from companion.state import Demand, MotorCommand, NavState

NOTICE_S = 10.0  # without way for this long
HIGH_THROTTLE = 0.75  # of what is allowed: less, and the boat is not trying
ASKED_SHARE = 0.5  # of min_speed_m_s: who asks for less wants to stay
WAY_SHARE = 0.1  # of min_speed_m_s: made good, and less counts as nothing
ALIGNED_RAD = 0.8  # a boat that still turns is not yet trying
SET_TIME_S = 20.0  # over which the set is remembered


class Verdict(IntEnum):
    """What to think of the way that is made."""

    MAKING_WAY = 0
    NO_HEADWAY = 1  # the water is as fast as the boat
    STUCK = 2  # something holds it


class Headway:
    """`verdict` is the present judgement; `stalled_s` how long there has been none while trying."""

    __slots__ = ("_set_east_m_s", "_set_north_m_s", "stalled_s", "verdict")

    def __init__(self) -> None:
        self.verdict = Verdict.MAKING_WAY
        self.stalled_s = 0.0
        self._set_north_m_s = self._set_east_m_s = 0.0

    def reset(self) -> None:
        """Begin to judge anew; what is known of the set stays."""
        self.verdict, self.stalled_s = Verdict.MAKING_WAY, 0.0

    def update(
        self,
        demand: Demand | None,
        command: MotorCommand,
        nav: NavState | None,
        config: BoatConfig,
        dt_s: float,
    ) -> Verdict:
        """Judge one tick: what guidance asked, what the motors were given, how the boat moves over ground.

        Ticks on which the boat does not try (no closed loops, little speed asked for, bow off the heading)
        neither count nor clear; way made good clears.
        """
        if demand is None or nav is None:
            self.reset()
            return self.verdict
        slow_m_s = config.guidance.min_speed_m_s
        c, s = math.cos(demand.heading_rad), math.sin(demand.heading_rad)
        ahead_m_s = nav.north_m_s * c + nav.east_m_s * s
        if ahead_m_s > WAY_SHARE * slow_m_s:
            share = dt_s / SET_TIME_S
            self._set_north_m_s += share * (nav.set_north_m_s - self._set_north_m_s)
            self._set_east_m_s += share * (nav.set_east_m_s - self._set_east_m_s)
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
            if self.stalled_s >= NOTICE_S and self.verdict is Verdict.MAKING_WAY:
                through_m_s = throttle * config.handling.top_speed_m_s
                left_m_s = through_m_s + self._set_north_m_s * c + self._set_east_m_s * s
                self.verdict = Verdict.STUCK if left_m_s > slow_m_s else Verdict.NO_HEADWAY
        return self.verdict
