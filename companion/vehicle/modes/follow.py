"""FOLLOW: whom the boat follows, and how it keeps its place beside it."""

import math

from companion.config.boat_config import BoatConfig, Follow
from companion.core.geo import LocalFrame, Point, distance_m
from companion.core.intent import HoldCourse, Intent, KeepStation
from companion.core.requests import OtherVehicle
from companion.core.state import NavState

_AHEAD_S = 1.0  # a position is carried on no longer than this


class Following:
    """Remembers where the one that is followed was last."""

    __slots__ = ("_at_s", "_lead")

    def __init__(self) -> None:
        self._lead: OtherVehicle | None = None
        self._at_s = -math.inf

    def sight(self, sighting: OtherVehicle, setting: Follow, now_s: float) -> bool:
        """Another vehicle says where it is. Whether it is the one to follow."""
        chosen = setting.system_id
        if chosen == 0 and self._lead is not None and now_s - self._at_s <= setting.timeout_s:
            chosen = self._lead.system_id
        if chosen not in (0, sighting.system_id):
            return False
        self._lead, self._at_s = sighting, now_s
        return True

    def fault(self, nav: NavState, frame: LocalFrame, setting: Follow, now_s: float) -> str:
        """Why nobody can be followed now; empty when somebody can."""
        lead = self._lead
        if lead is None or now_s - self._at_s > setting.timeout_s:
            return f"system {setting.system_id} is not heard" if setting.system_id else "no vehicle is heard"
        away_m = distance_m(nav.point, frame.to_local(lead.position))
        if 0.0 < setting.max_distance_m < away_m:
            return (
                f"system {lead.system_id} is {away_m:.0f} m away (FOLL_DIST_MAX {setting.max_distance_m:g})"
            )
        return ""

    def intent(
        self, nav: NavState, frame: LocalFrame, config: BoatConfig, limit_m_s: float, now_s: float
    ) -> Intent:
        """Make for the place beside the one that is followed; only after `fault` had none."""
        lead, setting = self._lead, config.follow
        if lead is None:
            return KeepStation(nav.point)
        place = self._place(lead, frame, setting, now_s)
        min_speed = config.guidance.min_speed_m_s
        if math.hypot(lead.north_m_s, lead.east_m_s) < 0.5 * min_speed:
            return KeepStation(place)
        north = lead.north_m_s + setting.gain_per_s * (place.north_m - nav.north_m)
        east = lead.east_m_s + setting.gain_per_s * (place.east_m - nav.east_m)
        speed = math.hypot(north, east)
        onward = math.atan2(lead.east_m_s, lead.north_m_s)
        along = north * math.cos(onward) + east * math.sin(onward)
        if speed < min_speed or along < 0.0:  # too far ahead: slow down rather than turn about
            return HoldCourse(onward, min(max(along, 0.0), limit_m_s))
        return HoldCourse(math.atan2(east, north), min(speed, limit_m_s))

    def _place(self, lead: OtherVehicle, frame: LocalFrame, setting: Follow, now_s: float) -> Point:
        ahead_s = min(now_s - self._at_s, _AHEAD_S)
        at = frame.to_local(lead.position)
        north, east = setting.offset_x_m, setting.offset_y_m
        if setting.offset_type == 1:
            c, s = math.cos(lead.heading_rad), math.sin(lead.heading_rad)
            north, east = north * c - east * s, north * s + east * c
        return Point(
            at.north_m + lead.north_m_s * ahead_s + north, at.east_m + lead.east_m_s * ahead_s + east
        )
