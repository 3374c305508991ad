"""The way that a mission leads next: the leg to the waypoint of now, and the corners of the way behind it.

Close waypoints are joined by a straightened line (`straightening.py`); each is still reached in its turn.
"""

from collections.abc import Mapping

from companion.core.geo import Line, LocalFrame, Point, distance_m
from companion.core.intent import FollowLeg
from companion.guidance.leg import Leg
from companion.vehicle.mission import steps
from companion.vehicle.mission.steps import Mission, Waypoint, locate
from companion.vehicle.mission.straightening import straighten

MOST = 48  # waypoints of look-ahead
_RENEWED_AT = 16  # remaining waypoints at which the look-ahead is renewed
_MOST_STEPS = 100
_MOST_CORNERS = 16  # passed to guidance


class MissionRoute:
    """leg: the one to the waypoint of now, None until it is laid."""

    def __init__(self) -> None:
        self.leg: Leg | None = None
        self._places: list[Point] = []  # where the route begins, then the waypoints in turn
        self._radii_m: list[float] = []  # theirs, 0 the boat's own
        self._corners: list[tuple[Point, int]] = []  # each with its place; none: no route is known
        self._passed = 0  # the place that the leg leads from
        self._approached = 0  # the last place that the boat was near to in its turn
        self._is_open = False  # more waypoints follow than were looked at
        self._is_known = False  # whether the leg knows what follows it
        self._intent: FollowLeg | None = None

    def forget(self) -> None:
        """Start the leg anew."""
        self.leg = None
        self._approached = self._passed
        self.forget_onward()

    def forget_onward(self) -> None:
        """The items after the leg may have changed."""
        self._is_known, self._corners = False, []

    def pass_waypoint(self) -> None:
        """The mission has advanced to its next item, from the end of this leg."""
        if self.leg is not None:
            self.leg = None
            self._passed += 1

    def lay(self, waypoint: Waypoint, start: Point, frame: LocalFrame) -> Leg:
        """The leg to the waypoint; a new one begins at start."""
        if self.leg is None:
            self.leg = Leg(start, locate(waypoint.position, frame, start), None, waypoint.radius_m)
            self._is_known = False
        return self.leg

    def look_ahead(
        self, mission: Mission, seq: int, jumps: Mapping[int, int], frame: LocalFrame, own_radius_m: float
    ) -> None:
        """Once a leg, find the waypoints after item seq, which this leg belongs to."""
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
            corner, since = self._corners[self._chord()]
            places = [corner, *self._places[since + 1 : self._passed + 1]]
            radii_m = self._radii_m[since : self._passed + 1]
        self._approached += len(places) - 1 - self._passed
        self._passed = len(places) - 1
        places.append(leg.end)
        radii_m.append(leg.radius_m)
        for waypoint in ahead:
            places.append(locate(waypoint.position, frame, places[-1]))
            radii_m.append(waypoint.radius_m)
        self._places, self._radii_m, self._is_open, self._intent = places, radii_m, is_open, None
        self._corners = straighten(places, [radius_m or own_radius_m for radius_m in radii_m])

    def note_approach(self, here: Point, own_radius_m: float) -> None:
        """A boat that cuts a corner behind close waypoints comes near to them before their legs begin."""
        self._approached = max(self._approached, self._passed)
        for place, radius_m in zip(
            self._places[self._approached + 1 :], self._radii_m[self._approached + 1 :], strict=True
        ):
            if distance_m(here, place) > (radius_m or own_radius_m):
                break
            self._approached += 1
        if self.leg is not None and self._approached > self._passed:
            self.leg.was_near = True

    def intent(self, leg: Leg, start: Point | None, speed_m_s: float, here: Point) -> FollowLeg:
        """Sail from corner to corner, as long as the leg begins at start; else the leg alone.

        A boat that has passed the next corner, which is the last or lies beyond the leg's end, without ending
        the leg sails to the leg's end from where it is.
        """
        at = self._chord()
        if self._corners and self._is_beyond_leg(at, here):
            leg.begin_at(here)
        if not self._corners or leg.start != start:
            self._corners = []
            return leg.intent(speed_m_s)
        ahead = [corner for corner, _ in self._corners[at : at + 3 + _MOST_CORNERS]]
        old = self._intent
        if old is None or (old.start, old.end, old.speed_m_s) != (ahead[0], ahead[1], speed_m_s):
            self._intent = old = FollowLeg(
                ahead[0],
                ahead[1],
                speed_m_s,
                ahead[2] if len(ahead) > 2 else None,
                self._radii_m[self._corners[at + 1][1]],
                tuple(ahead[3:]),
            )
        return old

    def _is_beyond_leg(self, at: int, here: Point) -> bool:
        corner, place = self._corners[at + 1]
        if at + 2 < len(self._corners) and place == self._passed + 1:
            return False
        line = Line(self._corners[at][0], corner)
        return line.along_and_cross_track_m(here)[0] > line.length_m

    def _chord(self) -> int:
        """The index of the corner passed last."""
        at = 0
        while at < len(self._corners) - 2 and self._corners[at + 1][1] <= self._passed:
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
            case steps.Jump(target, times):
                goes = times < 0 or jumps.get(seq, 0) < times
                if goes and jumped:
                    return ahead, True
                if goes:
                    seq, jumped = target - 1, True
            case steps.GoRound() | steps.Wait() | steps.Turn() | steps.HandOver() | steps.ReturnHome():
                return ahead, False
    return ahead, True
