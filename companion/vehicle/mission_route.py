"""The way that a mission leads next: the leg to the waypoint of now, and the corners of the way behind it.

Waypoints that make no corner are left out. The corners are those of D. H. Douglas and T. K. Peucker
("Algorithms for the reduction of the number of points required to represent a digitized line or its
caricature", *Cartographica* 10, 1973): the straight way between two of them passes every waypoint between,
one after the other, within SHIFT_SHARE of its radius. So a zigzag from cell to cell of a grid becomes
straight, and each of its waypoints is still reached in its turn.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

from companion.geo import Line, LocalFrame, Point, bearing_rad, distance_m
from companion.units import wrap_pi
from companion.vehicle.intent import FollowLeg
from companion.vehicle.leg import Leg
from companion.vehicle.mission_steps import (
    GoRound,
    HandOver,
    Jump,
    Mission,
    ReturnHome,
    Turn,
    Wait,
    Waypoint,
)
from companion.vehicle.places import locate

MOST = 48  # waypoints that are looked ahead
SHIFT_SHARE = 0.45  # of a waypoint's radius: how far from it the way may pass where it makes no corner
GENTLE_RAD = math.radians(30.0)  # a waypoint in a bend that turns on by less than this is kept: no zigzag
STRAIGHT_RAD = math.radians(3.0)
BACK_SHARE = 0.95  # of its radius: a waypoint this near to where the way begins or ends is not turned back to
SHARP_RAD = math.radians(100.0)  # such a turn is one back
_RENEWED_AT = 16  # waypoints left of those that were looked ahead
_MOST_STEPS = 100
_MOST_CORNERS = 16  # told to guidance


class MissionRoute:
    """leg: the one to the waypoint of now, None until it is laid."""

    __slots__ = ("_corners", "_intent", "_is_known", "_is_open", "_passed", "_places", "_radii_m", "leg")

    def __init__(self) -> None:
        self.leg: Leg | None = None
        self._places: list[Point] = []  # where the route begins, then the waypoints in turn
        self._radii_m: list[float] = []  # theirs, 0 the boat's own
        self._corners: list[int] = []  # which of the places are; none: no route is known
        self._passed = 0  # the place that the leg leads from
        self._is_open = False  # more waypoints follow than were looked at
        self._is_known = False  # whether the leg knows what follows it
        self._intent: FollowLeg | None = None

    def forget(self) -> None:
        """The leg is to be laid anew."""
        self.leg = None
        self.forget_onward()

    def forget_onward(self) -> None:
        """What comes behind the leg may be another."""
        self._is_known, self._corners = False, []

    def pass_waypoint(self) -> None:
        """The mission has gone on to its next item, from where this leg ends."""
        if self.leg is not None:
            self.leg = None
            self._passed += 1

    def lay(self, waypoint: Waypoint, start: Point, frame: LocalFrame) -> Leg:
        """The leg to the waypoint; from start, if it has not been laid yet."""
        if self.leg is None:
            self.leg = Leg(start, locate(waypoint.position, frame, start), None, waypoint.radius_m)
            self._is_known = False
        return self.leg

    def look_ahead(
        self, mission: Mission, seq: int, jumps: Mapping[int, int], frame: LocalFrame, own_radius_m: float
    ) -> None:
        """Find out, once a leg, where the way leads behind the item seq, which this leg belongs to."""
        leg = self.leg
        if leg is None or self._is_known:
            return
        self._is_known = True
        ahead, is_open = waypoints_ahead(mission, seq, jumps)
        leg.turn_onto(locate(ahead[0].position, frame, leg.end) if ahead else None)
        left = len(self._places) - 1 - self._passed if self._corners else 0
        if left > (_RENEWED_AT if self._is_open else 0):
            return
        places, radii_m = [leg.start], [leg.radius_m]
        if left > 0:  # what was straightened stays so
            since = self._corners[self._chord()]
            places = self._places[since : self._passed + 1]
            radii_m = self._radii_m[since : self._passed + 1]
        self._passed = len(places) - 1
        places.append(leg.end)
        radii_m.append(leg.radius_m)
        for waypoint in ahead:
            places.append(locate(waypoint.position, frame, places[-1]))
            radii_m.append(waypoint.radius_m)
        self._places, self._radii_m, self._is_open, self._intent = places, radii_m, is_open, None
        self._corners = corners_of(places, [radius_m or own_radius_m for radius_m in radii_m])

    def intent(self, leg: Leg, start: Point | None, speed_m_s: float) -> FollowLeg:
        """Sail from corner to corner, as long as the leg begins at start; else the leg alone."""
        if not self._corners or leg.start != start:
            self._corners = []
            return leg.intent(speed_m_s)
        at = self._chord()
        ahead = [self._places[n] for n in self._corners[at : at + 3 + _MOST_CORNERS]]
        old = self._intent
        if old is None or (old.start, old.end, old.speed_m_s) != (ahead[0], ahead[1], speed_m_s):
            self._intent = old = FollowLeg(
                ahead[0],
                ahead[1],
                speed_m_s,
                ahead[2] if len(ahead) > 2 else None,
                self._radii_m[self._corners[at + 1]],
                tuple(ahead[3:]),
            )
        return old

    def _chord(self) -> int:
        """Which of the corners was passed last."""
        at = 0
        while at < len(self._corners) - 2 and self._corners[at + 1] <= self._passed:
            at += 1
        return at


def waypoints_ahead(mission: Mission, seq: int, jumps: Mapping[int, int]) -> tuple[list[Waypoint], bool]:
    """Those that follow an item without a stop between, up to one where the boat stops; whether more may.

    jumps: how often each was made. One is looked beyond, and no other after it.
    """
    ahead: list[Waypoint] = []
    jumped, step = False, mission[seq]
    for _ in range(_MOST_STEPS):
        if len(ahead) == MOST:
            return ahead, True
        if isinstance(step, Waypoint) and step.hold_s > 0.0:
            return ahead, False
        seq += 1
        if seq >= len(mission):
            return ahead, False
        step = mission[seq]
        match step:
            case Waypoint():
                ahead.append(step)
            case Jump(target, times):
                goes = times < 0 or jumps.get(seq, 0) < times
                if goes and jumped:
                    return ahead, True
                if goes:
                    seq, jumped = target - 1, True
            case GoRound() | Wait() | Turn() | HandOver() | ReturnHome():
                return ahead, False
    return ahead, True


def corners_of(places: Sequence[Point], radii_m: Sequence[float]) -> list[int]:
    """Which of the places make a corner, the first and the last among them."""
    last = len(places) - 1
    met = [0, *(n for n in range(1, last) if not _is_back(n, places, radii_m)), last]
    bends = [0.0] * len(met)
    for n in range(1, len(met) - 1):
        before, at, after = (places[met[k]] for k in (n - 1, n, n + 1))
        if before != at != after:
            bends[n] = wrap_pi(bearing_rad(at, after) - bearing_rad(before, at))
    kept = {0, len(met) - 1}
    for n in range(1, len(met) - 1):
        goes_on = all(bends[n] * bends[k] >= -STRAIGHT_RAD * abs(bends[n]) for k in (n - 1, n + 1))
        if STRAIGHT_RAD < abs(bends[n]) < GENTLE_RAD and goes_on:
            kept.add(n)
    fixed = sorted(kept)
    spans = list(pairwise(fixed))
    while spans:
        first, end = spans.pop()
        worst = _worst([places[n] for n in met[first : end + 1]], [radii_m[n] for n in met[first : end + 1]])
        if worst:
            kept.add(first + worst)
            spans += [(first, first + worst), (first + worst, end)]
    return [met[n] for n in sorted(kept)]


def _is_back(n: int, places: Sequence[Point], radii_m: Sequence[float]) -> bool:
    """Whether the way only turns back at a place, near to where it begins or ends."""
    before, at, after = places[n - 1 : n + 2]
    turn = abs(wrap_pi(bearing_rad(at, after) - bearing_rad(before, at)))
    is_first = n == 1 and distance_m(before, at) <= BACK_SHARE * radii_m[n]
    is_last = n == len(places) - 2 and distance_m(at, after) <= BACK_SHARE * radii_m[n]
    return (is_first or is_last) and turn > SHARP_RAD


def _worst(places: Sequence[Point], radii_m: Sequence[float]) -> int:
    """Which place is farthest off the straight way from the first to the last; 0 if none is too far."""
    line = Line(places[0], places[-1])
    worst, found, farthest_m, farthest = 1.0, 0, 0.0, 0
    for n in range(1, len(places) - 1):
        along_m, cross_m = line.along_and_cross_track_m(places[n])
        off_m = math.hypot(cross_m, max(-along_m, along_m - line.length_m, 0.0))
        share = off_m / (SHIFT_SHARE * radii_m[n])
        if share > worst:
            worst, found = share, n
        back = (farthest_m - along_m) / (SHIFT_SHARE * radii_m[n])
        if back > worst:  # not one after the other
            worst, found = back, farthest or n
        if along_m > farthest_m:
            farthest_m, farthest = along_m, n
    return found
