"""Legs that are too short to be sailed one by one: a fair line through several at once.

Which item is sailed, and when it is passed, stays the mission's business; here is only which way the boat
goes meanwhile.
"""

from collections.abc import Sequence

from companion.geo import LocalFrame, Point, distance_m
from companion.state import NavState
from companion.vehicle.fair_line import SHIFT_SHARE, fair_line, is_short
from companion.vehicle.intent import FollowLeg
from companion.vehicle.leg import Leg
from companion.vehicle.mission_steps import Waypoint
from companion.vehicle.places import locate
from companion.vehicle.waypoints_ahead import MOST

_MOST_CORNERS = 16  # told to guidance
_RENEW = 24  # places passed


class ShortLegs:
    """The line, and where on it the boat is."""

    __slots__ = ("_at", "_corners", "_is_open", "_leg", "_passed", "_places", "_radius_m")

    def __init__(self, places: Sequence[Point], radii_m: Sequence[float], *, is_open: bool) -> None:
        """places: where the line begins, then the waypoints in turn. is_open: there are more behind them."""
        self._places = len(places)
        self._is_open = is_open
        self._corners = fair_line(places, radii_m)
        self._radius_m = (1.0 - SHIFT_SHARE) * min(radii_m)
        self._passed = 0
        self._at = 0
        self._leg = self._leg_from(0)

    def pass_waypoint(self) -> None:
        """The mission has gone on to its next item."""
        self._passed += 1

    @property
    def is_outdated(self) -> bool:
        """Whether the line is to be drawn anew, to look further ahead."""
        left = self._places - 1 - self._passed
        if left < 2:
            return left < 1 or self._is_open
        return self._is_open and self._passed >= _RENEW and self._corners[self._at][1] <= self._passed

    @property
    def leg_start(self) -> Point | None:
        """Where a line that is drawn anew begins; None at the waypoint that was passed last."""
        is_last = self._at == len(self._corners) - 2
        return self._corners[self._at][0] if is_last or self._passed < self._places - 2 else None

    def intent(self, nav: NavState, speed_m_s: float) -> FollowLeg:
        """Sail along the line at this speed over ground, as far as its corners allow."""
        while self._at < len(self._corners) - 2 and self._leg.has_ended(nav, self._radius_m):
            self._at += 1
            self._leg = self._leg_from(self._at)
        return self._leg.intent(speed_m_s)

    def _leg_from(self, at: int) -> Leg:
        start, end, *onward = (point for point, _ in self._corners[at : at + 2 + _MOST_CORNERS])
        return Leg(start, end, onward[0] if onward else None, self._radius_m, tuple(onward))


def line_ahead(
    last: ShortLegs | None, leg: Leg, onward: Sequence[Waypoint], frame: LocalFrame, own_radius_m: float
) -> ShortLegs | None:
    """The line to sail as an item begins; None where its leg and the next one are long.

    last: the line so far, which is kept as long as it looks far enough ahead. onward: the waypoints behind
    the leg.
    """
    start, radius_m = leg.start, leg.radius_m or own_radius_m
    if last is not None:
        if not last.is_outdated:
            return last
        start = last.leg_start or start
    if leg.next_end is None:
        return None
    shorter_m = min(distance_m(start, leg.end), distance_m(leg.end, leg.next_end))
    if start == leg.start and not is_short(shorter_m, radius_m):
        return None
    places, radii_m = [start, leg.end], [radius_m, radius_m]
    for waypoint in onward:
        places.append(locate(waypoint.position, frame, places[-1]))
        radii_m.append(waypoint.radius_m or own_radius_m)
        if not is_short(distance_m(places[-2], places[-1]), radii_m[-2]):
            return ShortLegs(places, radii_m, is_open=True)
    return ShortLegs(places, radii_m, is_open=len(onward) == MOST)
