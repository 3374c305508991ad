"""What a trial is: a routine that is shown the boat every tick, says what to sail, and ends with findings."""

import math
from collections.abc import Generator
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.intent import HoldHeading, Intent, KeepStation, Stop
from companion.core.state import MotorCommand, NavState
from companion.core.units import wrap_pi
from companion.sensors.readings import GnssFix

_STOP = Stop()
_COMING_S = 180.0
_RESTING_S = 8.0
_STILL_RAD_S = 0.03
_TURNING_S = 60.0
_AIMED_RAD = 0.1
_AIMED_S = 1.0


class Sight(NamedTuple):
    """What a trial sees of one tick.

    fix: only where a new one has come. command: what the motors were told last. The trial keeps within
    radius_m of the centre; is_fenced: there is a line about it that the boat brakes for; is_slowed: the
    look-out has seen something, be it spray, and the boat goes no faster than it can stop.
    """

    nav: NavState
    fix: GnssFix | None
    command: MotorCommand
    config: BoatConfig
    now_s: float
    centre: Point
    radius_m: float
    is_fenced: bool = False
    is_slowed: bool = False

    @property
    def off_m(self) -> float:
        """How far the boat is from the centre."""
        return distance_m(self.nav.point, self.centre)


class Finding(NamedTuple):
    """A parameter by its name, and the value that it should have, as stations see it."""

    name: str
    value: float


Routine = Generator[Intent, Sight, list[Finding]]
"""Yields what to sail and is sent the next tick's sight."""

Step = Generator[Intent, Sight, Sight]
"""A part of a routine; ends with the last sight."""


class TrialError(Exception):
    """The trial cannot go on, in words for the operator."""


def come_back(sight: Sight, near_m: float) -> Step:
    """Sail to the centre.

    Raises:
        TrialError: it is not reached.
    """
    until_s, station = sight.now_s + _COMING_S, KeepStation(sight.centre)
    while sight.off_m > near_m:
        if sight.now_s > until_s:
            raise TrialError("the boat does not get back to its station")
        sight = yield station
    return sight


def rest(sight: Sight, seconds: float) -> Step:
    """Drift for so long, and on until the boat hardly turns any more."""
    began_s = sight.now_s
    while sight.now_s - began_s < seconds or (
        abs(sight.nav.yaw_rate_rad_s) > _STILL_RAD_S and sight.now_s - began_s < _RESTING_S
    ):
        sight = yield _STOP
    return sight


def aim(sight: Sight, heading_rad: float, speed_m_s: float = 0.0) -> Step:
    """Turn the bow there, and keep it there for a moment.

    Raises:
        TrialError: it does not come there.
    """
    until_s, aimed_s, intent = sight.now_s + _TURNING_S, math.inf, HoldHeading(heading_rad, speed_m_s)
    while sight.now_s < aimed_s + _AIMED_S:
        if sight.now_s > until_s:
            raise TrialError("the bow does not come round")
        is_aimed = abs(wrap_pi(heading_rad - sight.nav.heading_rad)) < _AIMED_RAD
        aimed_s = min(aimed_s, sight.now_s) if is_aimed else math.inf
        sight = yield intent
    return sight
