"""What the vehicle wants next: the modes' answer, guidance's input."""

from dataclasses import dataclass, field

from msgspec import Struct

from companion.core.geo import Line, Point


class Stop(Struct, frozen=True):
    """No thrust: the boat drifts."""


class Drive(Struct, frozen=True):
    """Thrust by hand, no loop closed. throttle and steering are −1..1; steering is positive to starboard."""

    throttle: float
    steering: float


@dataclass(frozen=True, slots=True)
class FollowLeg:
    """Sail the straight line start → end at speed_m_s over ground.

    next_end is where the leg after this one leads: guidance slows for the corner between them. None means
    that the boat is to stop at `end`. radius_m is how near `end` must be passed, 0 the boat's own radius.
    onward are the corners from next_end on, where they lie close together, as far as they are known: the boat
    must be able to stop at the last of them. Empty: nothing is known.
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
    """Stay near a point against current and wind."""

    point: Point


class FollowCircle(Struct, frozen=True):
    """Sail round a point at speed_m_s over ground, and no faster than the turn allows."""

    centre: Point
    radius_m: float
    clockwise: bool
    speed_m_s: float


class HoldCourse(Struct, frozen=True):
    """Make good a course over ground, whatever the water does."""

    course_rad: float
    speed_m_s: float


class HoldHeading(Struct, frozen=True):
    """Point the bow there and make speed along it, negative astern; the water may set the boat aside."""

    heading_rad: float
    speed_m_s: float


class HoldTurn(Struct, frozen=True):
    """Turn at a rate, positive to starboard, and make speed along the bow; at rate 0 hold the heading."""

    yaw_rate_rad_s: float
    speed_m_s: float


Hold = HoldCourse | HoldHeading | HoldTurn
Intent = Stop | Drive | FollowLeg | KeepStation | FollowCircle | Hold
