"""Intents: the output of the modes, the input of guidance."""

import math
from dataclasses import dataclass, field

from msgspec import Struct

from companion.core.geo import Line, Point


class Stop(Struct, frozen=True):
    """No thrust: the boat drifts."""


class Drive(Struct, frozen=True):
    """Manual thrust without closed loops. throttle, steering: −1..1; steering is positive to starboard."""

    throttle: float
    steering: float


@dataclass(frozen=True, slots=True)
class FollowLeg:
    """Sail the straight line start → end at speed_m_s over ground.

    next_end: end of the next leg, for which guidance slows down; None: stop at `end`. radius_m: acceptance
    radius of `end`, 0 for the configured one. onward: the corners after next_end, where they are close
    together, as far as known; the boat must be able to stop at the last. Empty: unknown.
    """

    start: Point
    end: Point
    speed_m_s: float
    next_end: Point | None = None
    radius_m: float = 0.0
    onward: tuple[Point, ...] = ()
    line: Line = field(init=False, repr=False, compare=False)
    next_line: Line | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "line", Line(self.start, self.end))
        onward = None if self.next_end is None else Line(self.end, self.next_end)
        object.__setattr__(self, "next_line", onward)


class KeepStation(Struct, frozen=True):
    """Stay near a point in current and wind."""

    point: Point


class FollowCircle(Struct, frozen=True):
    """Circle a point at speed_m_s over ground, or as fast as the turn allows."""

    centre: Point
    radius_m: float
    clockwise: bool
    speed_m_s: float


class HoldCourse(Struct, frozen=True):
    """Make good a course over ground."""

    course_rad: float
    speed_m_s: float


class HoldHeading(Struct, frozen=True):
    """Hold a heading at a speed along it, negative astern; the boat may drift sideways.

    turns_beyond_rad: with the heading farther off, a boat that cannot turn on the spot makes way ahead.
    """

    heading_rad: float
    speed_m_s: float
    turns_beyond_rad: float = math.inf


class HoldTurn(Struct, frozen=True):
    """Turn at a rate, positive to starboard, with a speed along the bow; at rate 0 hold the heading."""

    yaw_rate_rad_s: float
    speed_m_s: float


Hold = HoldCourse | HoldHeading | HoldTurn
Intent = Stop | Drive | FollowLeg | KeepStation | FollowCircle | Hold
