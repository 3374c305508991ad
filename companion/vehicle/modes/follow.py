"""FOLLOW: keep a place relative to another vehicle."""

import math

from companion.config.boat_config import Follow
from companion.core.geo import LocalFrame, Point, distance_m, from_body_axes
from companion.core.intent import HoldCourse, Intent, KeepStation
from companion.core.requests import OtherVehicle
from companion.core.status_text import Severity, StatusText
from companion.vehicle.modes.controller import ModeController, ModeInputs
from companion.vehicle.modes.station import Station

_EXTRAPOLATION_S = 1.0  # a position is extrapolated no longer than this


class FollowMode(ModeController):
    """Keeps station while there is no vehicle to follow. lead: the latest report of the one followed."""

    def __init__(self, status_texts: list[StatusText]) -> None:
        self.lead: OtherVehicle | None = None
        self._lead_s = -math.inf
        self._status_texts = status_texts
        self._station = Station()
        self._has_lost_lead = False

    def ingest(self, report: OtherVehicle, setting: Follow, now_s: float) -> bool:
        """Another vehicle reports its position. Whether it is the one to follow."""
        chosen = setting.system_id
        if chosen == 0 and self.lead is not None and now_s - self._lead_s <= setting.timeout_s:
            chosen = self.lead.system_id
        if chosen not in (0, report.system_id):
            return False
        self.lead, self._lead_s = report, now_s
        return True

    def fault(self, inputs: ModeInputs) -> str:
        """Why no vehicle can be followed now; empty when one can."""
        lead, setting = self.lead, inputs.config.follow
        if lead is None or inputs.now_s - self._lead_s > setting.timeout_s:
            return f"system {setting.system_id} is not heard" if setting.system_id else "no vehicle is heard"
        away_m = distance_m(inputs.nav.point, inputs.frame.to_local(lead.position))
        if 0.0 < setting.max_distance_m < away_m:
            limit = f"FOLL_DIST_MAX {setting.max_distance_m:g}"
            return f"system {lead.system_id} is {away_m:.0f} m away ({limit})"
        return ""

    def enter(self, inputs: ModeInputs | None) -> None:  # noqa: ARG002
        self._has_lost_lead = False

    def intent(self, inputs: ModeInputs) -> Intent:
        """Follow the lead, or keep station where it was lost."""
        fault, lead = self.fault(inputs), self.lead
        if not fault and lead is not None:
            self._has_lost_lead = False
            return self._follow(lead, inputs)
        if not self._has_lost_lead:
            self._has_lost_lead = True
            self._station.set(inputs.position)
            self._status_texts.append(StatusText(Severity.WARNING, f"FOLLOW: {fault}, keeping station"))
        return self._station.intent(inputs)

    def _follow(self, lead: OtherVehicle, inputs: ModeInputs) -> Intent:
        nav, setting, limit_m_s = inputs.nav, inputs.config.follow, inputs.speed_m_s
        place = self._place(lead, inputs.frame, setting, inputs.now_s)
        min_speed = inputs.config.guidance.min_speed_m_s
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
        ahead_s = min(now_s - self._lead_s, _EXTRAPOLATION_S)
        at = frame.to_local(lead.position)
        north, east = setting.offset_x_m, setting.offset_y_m
        if setting.offset_type == 1:
            north, east = from_body_axes(north, east, lead.heading_rad)
        return Point(
            at.north_m + lead.north_m_s * ahead_s + north, at.east_m + lead.east_m_s * ahead_s + east
        )
