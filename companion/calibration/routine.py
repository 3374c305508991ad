"""A calibration routine: a generator that yields an intent a tick and returns findings.

The runner brings its inputs up to date while it is suspended.
"""

import math
from collections.abc import Generator
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.intent import HoldHeading, Intent, KeepStation, Stop
from companion.core.readings import GnssFix
from companion.core.state import MotorCommand, NavState
from companion.core.units import wrap_pi

_STOP = Stop()
_COMING_S = 180.0
_RESTING_S = 8.0
_STILL_RAD_S = 0.03
_TURNING_S = 60.0
_AIMED_RAD = 0.1
_AIMED_S = 1.0


@dataclass(slots=True)
class RoutineInputs:
    """The present tick's inputs.

    fix: only a new one. command: of the last tick. The routine keeps within radius_m of the centre.
    is_fenced: there is a fence, which the boat brakes for. is_slowed: obstacle avoidance limits the speed.
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


class TrialFinding(NamedTuple):
    """A parameter's name, and the value found for it, in the parameter's unit."""

    name: str
    value: float


Result = TypeVar("Result")
Step = Generator[Intent, None, Result]
"""A part of a routine."""
Routine = Step[list[TrialFinding]]


class CalibrationError(Exception):
    """The calibration cannot go on, in words for the operator."""


def come_back(inputs: RoutineInputs) -> Step[None]:
    """Sail to the centre. Raises CalibrationError: it is not reached."""
    until_s, station = inputs.now_s + _COMING_S, KeepStation(inputs.centre)
    while inputs.off_m > inputs.config.guidance.station_radius_m:
        if inputs.now_s > until_s:
            raise CalibrationError("the boat does not get back to its station")
        yield station


def rest(inputs: RoutineInputs, seconds: float) -> Step[None]:
    """Drift for a time, and until the boat has stopped turning."""
    began_s = inputs.now_s
    while inputs.now_s - began_s < seconds or (
        abs(inputs.nav.yaw_rate_rad_s) > _STILL_RAD_S and inputs.now_s - began_s < _RESTING_S
    ):
        yield _STOP


def aim(inputs: RoutineInputs, heading_rad: float, speed_m_s: float = 0.0) -> Step[None]:
    """Turn to a heading, and hold it for _AIMED_S. Raises CalibrationError: the heading is not reached."""
    until_s, aimed_s = inputs.now_s + _TURNING_S, math.inf
    intent = HoldHeading(heading_rad, speed_m_s, _AIMED_RAD)
    while inputs.now_s < aimed_s + _AIMED_S:
        if inputs.now_s > until_s:
            raise CalibrationError("the bow does not come round")
        is_aimed = abs(wrap_pi(heading_rad - inputs.nav.heading_rad)) < _AIMED_RAD
        aimed_s = min(aimed_s, inputs.now_s) if is_aimed else math.inf
        yield intent
