"""A straight leg under way, and when its end counts as reached."""

from companion.core.geo import Line, Point, distance_m
from companion.core.intent import FollowLeg
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.guidance.fillet import PASSED_RADII, SHARP_RAD

_LEVEL_M = 1e-6  # rounding error after a leg straight back
_LEFT_RADII = (
    1.25  # from the end: beyond it, a boat that was within one radius has left; a sharp turn, planned
)
# to pass within one radius, may miss that by as much


def passing_m(line: Line, next_line: Line | None, radius_m: float) -> float:
    """How near to a leg's end the boat passes it; nearer where it stops, and in a sharp turn."""
    if next_line is None:
        return radius_m
    is_sharp = abs(wrap_pi(next_line.course_rad - line.course_rad)) > SHARP_RAD
    return (_LEFT_RADII if is_sharp else PASSED_RADII) * radius_m


class Leg:
    """From its start to `end`.

    next_end: end of the next leg, None to stop. radius_m: acceptance radius, 0 for the configured one.
    was_near: whether the boat has been within it. onward: the corners after next_end, where they are close
    together.
    """

    def __init__(
        self,
        start: Point,
        end: Point,
        next_end: Point | None = None,
        radius_m: float = 0.0,
        onward: tuple[Point, ...] = (),
    ) -> None:
        self._line = Line(start, end)
        self._next_line = None if next_end is None else Line(end, next_end)
        self._intent: FollowLeg | None = None
        self.was_near = False
        self.end = end
        self.next_end = next_end
        self.radius_m = radius_m
        self.onward = onward

    @property
    def start(self) -> Point:
        """The start; it moves when the boat is carried past the end."""
        return self._line.start

    def turn_onto(self, next_end: Point | None) -> None:
        """Replace the next leg."""
        self.next_end, self._intent = next_end, None
        self._next_line = None if next_end is None else Line(self.end, next_end)

    def has_ended(self, nav: NavState, own_radius_m: float) -> bool:
        """Whether the boat has been within the radius of the end, or has passed it within twice that.

        A corner ends at its bisector, unless the boat leaves the radius before. A boat carried farther off,
        past the end or abeam of it, starts a new line to the end.
        """
        radius_m = self.radius_m or own_radius_m
        along_m, cross_m = self._line.along_and_cross_track_m(nav.point)
        to_go_m = self._line.length_m - along_m
        away_m = distance_m(nav.point, self.end)
        if self._next_line is None:
            if away_m <= radius_m:
                return True
        elif away_m <= PASSED_RADII * radius_m:
            self.was_near = self.was_near or away_m <= radius_m
            beyond_m, _ = self._next_line.along_and_cross_track_m(nav.point)
            inside_m = passing_m(self._line, self._next_line, radius_m)
            is_over = to_go_m <= inside_m and beyond_m >= to_go_m - _LEVEL_M
            return is_over or (self.was_near and away_m > _LEFT_RADII * radius_m)
        is_off = abs(cross_m) > PASSED_RADII * radius_m
        if to_go_m > (PASSED_RADII * radius_m if is_off else 0.0):
            return False
        if not is_off:
            return True
        self.begin_at(nav.point)
        return False

    def begin_at(self, start: Point) -> None:
        """Aim at the end from another place."""
        self._line, self._intent = Line(start, self.end), None

    def intent(self, speed_m_s: float) -> FollowLeg:
        """The intent at this speed over ground."""
        intent = self._intent
        if intent is None or intent.speed_m_s != speed_m_s:
            start = self._line.start
            self._intent = intent = FollowLeg(
                start, self.end, speed_m_s, self.next_end, self.radius_m, self.onward
            )
        return intent
