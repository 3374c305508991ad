"""The leg to the waypoint of now, and what is known of the way behind it."""

from companion.geo import LocalFrame, Point
from companion.state import NavState
from companion.vehicle.intent import FollowLeg
from companion.vehicle.leg import Leg
from companion.vehicle.mission_steps import Mission, Waypoint
from companion.vehicle.places import locate
from companion.vehicle.short_legs import ShortLegs, line_ahead
from companion.vehicle.waypoints_ahead import waypoints_ahead


class WaypointLeg:
    """leg: None until it is laid."""

    __slots__ = ("_is_onward_known", "_short_legs", "leg")

    def __init__(self) -> None:
        self.leg: Leg | None = None
        self._is_onward_known = False  # whether the leg knows the one after it
        self._short_legs: ShortLegs | None = None  # this one and those after it, where they are that

    def forget(self) -> None:
        """It is to be laid anew."""
        self.leg = self._short_legs = None

    def forget_onward(self) -> None:
        """What comes behind it may be another."""
        self._is_onward_known, self._short_legs = False, None

    def pass_waypoint(self) -> None:
        """The mission has gone on to its next item, from where this leg ends."""
        self.leg = None
        if self._short_legs is not None:
            self._short_legs.pass_waypoint()

    def lay(self, waypoint: Waypoint, start: Point, frame: LocalFrame) -> Leg:
        """The leg to the waypoint; from start, if it has not been laid yet."""
        leg = self.leg
        if leg is None:
            leg = self.leg = Leg(start, locate(waypoint.position, frame, start), None, waypoint.radius_m)
            self._is_onward_known = False
        return leg

    def look_ahead(
        self, mission: Mission, seq: int, jumps: dict[int, int], frame: LocalFrame, own_radius_m: float
    ) -> None:
        """Find out, once, where the way leads behind the item seq, which this leg belongs to."""
        leg = self.leg
        if leg is None or self._is_onward_known:
            return
        self._is_onward_known = True
        ahead = waypoints_ahead(mission, seq, jumps)
        leg.turn_onto(locate(ahead[0].position, frame, leg.end) if ahead else None)
        self._short_legs = line_ahead(self._short_legs, leg, ahead, frame, own_radius_m)

    def intent(self, leg: Leg, start: Point | None, nav: NavState, speed_m_s: float) -> FollowLeg:
        """Sail the leg, or the line through short ones while it is theirs: as long as it begins at start."""
        if self._short_legs is not None and leg.start == start:
            return self._short_legs.intent(nav, speed_m_s)
        self._short_legs = None
        return leg.intent(speed_m_s)
