"""Vessels with AIS near the boat: where each is by now, and how far it extends.

A report is extrapolated by its course and speed. Its age limit and its error follow from ITU-R M.1371-5: the
intervals of reports (tables 1 and 2), and that class A reports more often while its heading changes by 5°.
"""

import math
from dataclasses import dataclass
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.geo import LocalFrame, Point
from companion.core.readings import AisReading, AisVessel
from companion.core.state import NavState
from companion.core.units import KNOT_M_S
from companion.sensors.nmea.ais import LIFE_S

# Half a ship's beam, the margin and the error of its position are 30 m, 25 s at cruise: twice that
LOOK_AHEAD_S: Final = 60.0
_MOST: Final = 4  # each costs the planner as much as a moving obstacle that the sonar sees
_MISSED: Final = 6  # reports in a row, of which half get lost at worst: once in 64 times
_ANCHORED, _MOORED = 1, 5  # of the navigational status
_AT_REST_S, _UNDER_WAY_S, _CLASS_B_S = 180.0, 10.0, 30.0
_SLOW_A_M_S, _SLOW_B_M_S = 3.0 * KNOT_M_S, 2.0 * KNOT_M_S
_UNTOLD_RAD: Final = math.radians(5.0)
_RESOLUTION_M_S: Final = 0.1 * KNOT_M_S
_95_SIGMAS: Final = 2.45  # 95 % of a circular error
# Length and beam where a vessel does not tell them. Class A: about 300 gross tonnage, from which on it is
# mandatory (SOLAS V/19); class B: the longest recreational craft (directive 2013/53/EU)
_SIZES_M: Final = {False: (50.0, 10.0), True: (24.0, 6.0)}


@dataclass(frozen=True, slots=True)
class Vessel:
    """at: the middle of its hull now. sigma_m: of its report age_s ago; sigma_m_s: of its velocity."""

    name: str
    at: Point
    north_m_s: float
    east_m_s: float
    heading_rad: float
    half_length_m: float
    half_beam_m: float
    sigma_m: float
    sigma_m_s: float
    age_s: float

    @property
    def is_at_rest(self) -> bool:
        """Whether it is at anchor, moored or drifts."""
        return math.hypot(self.north_m_s, self.east_m_s) <= _SLOW_B_M_S

    def variance_m2(self, ahead_s: float) -> float:
        """Of its place on each axis, so much later."""
        return self.sigma_m**2 + (self.sigma_m_s * (self.age_s + ahead_s)) ** 2

    def meets_s(self, here: Point, speed_m_s: float, margin_m: float) -> float:
        """No boat of this speed comes within the margin sooner: on a straight course it closes most now."""
        north, east = self.at.north_m - here.north_m, self.at.east_m - here.east_m
        away_m = max(math.hypot(north, east), 1e-6)
        closing_m_s = speed_m_s - (self.north_m_s * north + self.east_m_s * east) / away_m
        gap_m = away_m - self.half_length_m - margin_m - 2.0 * math.sqrt(self.variance_m2(0.0))
        if gap_m <= 0.0:
            return 0.0
        return gap_m / closing_m_s if closing_m_s > 0.0 else math.inf


def vessels_near(
    reading: AisReading | None,
    frame: LocalFrame | None,
    nav: NavState | None,
    config: BoatConfig,
    now_s: float,
) -> list[Vessel]:
    """Those that the boat may meet within LOOK_AHEAD_S, at most _MOST of them, the soonest first."""
    if reading is None or frame is None or nav is None:
        return []
    top_m_s, margin_m, found = config.handling.top_speed_m_s, config.avoidance.vessel_margin_m, []
    for report in reading.vessels:
        if now_s - report.time_s <= _life_s(report):
            vessel = _vessel(report, frame, now_s)
            if (meets_s := vessel.meets_s(nav.point, top_m_s, margin_m)) <= LOOK_AHEAD_S:
                found.append((meets_s, report.mmsi, vessel))
    return [vessel for _, _, vessel in sorted(found)[:_MOST]]


def _life_s(report: AisVessel) -> float:
    """How long its latest position is used."""
    speed_m_s = report.speed_m_s or 0.0
    if report.is_class_b:
        interval_s = _CLASS_B_S if speed_m_s > _SLOW_B_M_S else _AT_REST_S
    else:
        is_at_rest = report.status in (_ANCHORED, _MOORED) and speed_m_s <= _SLOW_A_M_S
        interval_s = _AT_REST_S if is_at_rest else _UNDER_WAY_S
    return min(_MISSED * interval_s, LIFE_S)


def _vessel(report: AisVessel, frame: LocalFrame, now_s: float) -> Vessel:
    course_rad = report.heading_rad if report.course_rad is None else report.course_rad
    speed_m_s = 0.0 if course_rad is None else report.speed_m_s or 0.0
    heading_rad = course_rad if report.heading_rad is None and speed_m_s > _SLOW_B_M_S else report.heading_rad
    usual_m = _SIZES_M[report.is_class_b]
    half_length_m = 0.5 * (report.bow_m + report.stern_m or usual_m[0])
    half_beam_m = 0.5 * (report.port_m + report.starboard_m or usual_m[1])
    ahead_m, right_m = 0.5 * (report.bow_m - report.stern_m), 0.5 * (report.starboard_m - report.port_m)
    if report.bow_m == 0 and report.port_m == 0:  # the antenna may be anywhere
        half_length_m, half_beam_m, ahead_m, right_m = 2.0 * half_length_m, 2.0 * half_beam_m, 0.0, 0.0
    if heading_rad is None:  # it may lie in any direction
        half_length_m = half_beam_m = half_length_m + abs(ahead_m)
        ahead_m = right_m = heading_rad = 0.0
    course_rad, age_s = course_rad or 0.0, max(now_s - report.time_s, 0.0)
    antenna = frame.to_local(report.position).moved(course_rad, age_s * speed_m_s)
    return Vessel(
        name=report.name or f"{report.mmsi:09d}",
        at=antenna.moved(heading_rad, ahead_m).moved(heading_rad + 0.5 * math.pi, right_m),
        north_m_s=speed_m_s * math.cos(course_rad),
        east_m_s=speed_m_s * math.sin(course_rad),
        heading_rad=heading_rad,
        half_length_m=half_length_m,
        half_beam_m=half_beam_m,
        sigma_m=report.error_m / _95_SIGMAS,
        sigma_m_s=_RESOLUTION_M_S + _UNTOLD_RAD * speed_m_s,
        age_s=age_s,
    )
