"""What the vehicle wants next: the modes' answer, guidance's input."""

from dataclasses import dataclass, field

from msgspec import Struct

from companion.geo import Line, Point


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
    """

    start: Point
    end: Point
    speed_m_s: float
    next_end: Point | None = None
    radius_m: float = 0.0
    line: Line = field(init=False, repr=False, compare=False)
    next_line: Line | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "line", Line(self.start, self.end))
        onward = None if self.next_end is None else Line(self.end, self.next_end)
        object.__setattr__(self, "next_line", onward)


class KeepStation(Struct, frozen=True):
    """Stay near a point against current and wind."""

    point: Point


Intent = Stop | Drive | FollowLeg | KeepStation
