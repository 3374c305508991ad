"""Movers ahead in time, and what an encounter costs.

A mover keeps its velocity (P. Fiorini and Z. Shiller, *Motion Planning in Dynamic Environments Using Velocity
Obstacles*, International Journal of Robotics Research 17(7), 1998). Its domain (E. M. Goodwin, *A Statistical
Study of Ship Domains*, Journal of Navigation 28, 1975) extends ahead of it, so passing ahead of crossing
traffic costs more than passing astern.
"""

import math
from typing import Final, NamedTuple

from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.motion import STEP_S, STEPS

NEAR: Final = 8.0  # a second at half the margin costs as much as a turn by 25°
_HIT: Final = 3.0  # more than no progress and every other term,
_SOON: Final = 3.0  # and more, the sooner
_BUMP: Final = 0.5  # m/s, added to the speed of a touch
_AHEAD_S: Final = 1.5  # a mover's domain reaches so far ahead
_NEW_M_S: Final = 0.5  # speed of a new echo that may move
_STILL: Final = 0.4  # probability that a new, isolated echo lies still
_UNLIKELY: Final = 0.05
HULL: Final = 0.6  # of the margin: half the hull's length and half a cell


class Predicted(NamedTuple):
    """A mover of one velocity, by step: place, squares of the distances of a touch and of its domain, in
    cells. weight: its probability.
    """

    north: list[float]
    east: list[float]
    touch2: float
    domain2: list[float]
    weight: float
    cell_m: float


def hit_cost(step: int, speed_m_s: float) -> float:
    """The cost of a touch at a step, with a relative speed."""
    return (_HIT + _SOON * (1.0 - step / STEPS)) * (_BUMP + speed_m_s)


def encounter_cost(mover: Predicted, norths: list[float], easts: list[float]) -> float:
    """The cost of a mover on the way along these places: in its domain, and the deeper a touch the more."""
    mover_n, mover_e, domain2s = mover.north, mover.east, mover.domain2
    total, least2, first = 0.0, mover.touch2, -1
    for step in range(len(norths)):
        off_n, off_e = norths[step] - mover_n[step], easts[step] - mover_e[step]
        squared = off_n * off_n + off_e * off_e
        if squared < domain2s[step]:
            total += (1.0 - math.sqrt(squared / domain2s[step])) ** 2
            if squared < least2:
                least2 = squared
                first = step if first < 0 else first
    cost = NEAR * total / STEPS
    if first >= 0:
        step = min(max(first, 1), len(norths) - 1)
        moved_n = norths[step] - norths[step - 1] - mover_n[step] + mover_n[step - 1]
        moved_e = easts[step] - easts[step - 1] - mover_e[step] + mover_e[step - 1]
        impact = math.hypot(moved_n, moved_e) * mover.cell_m / STEP_S  # m/s: the relative speed
        cost += hit_cost(first, impact) * (1.0 - math.sqrt(least2 / mover.touch2))
    return cost


def _hypotheses(track: Track, nav: NavState, now_s: float) -> list[tuple[float, float, float]]:
    """Velocities that a track may have, with their probabilities.

    A mover has its estimated one. A new echo may lie still, come towards the boat, or cross its bow; each is
    weighted by its likelihood given the estimated velocity.
    """
    if track.is_likely_mover:
        return [(track.north_m_s, track.east_m_s, 1.0)]
    at = track.point(now_s)
    north, east = at.north_m - nav.north_m, at.east_m - nav.east_m
    away_m = max(math.hypot(north, east), 1e-6)
    to_n, to_e = north / away_m, east / away_m
    off = wrap_pi(math.atan2(east, north) - nav.heading_rad)
    side = -_NEW_M_S if off > 0.0 else _NEW_M_S
    towards = (-_NEW_M_S * to_n, -_NEW_M_S * to_e)
    across = (-side * to_e, side * to_n)
    along_2 = 2.0 * track.pace_sigma_m_s(to_n, to_e) ** 2 + 1e-6
    across_2 = 2.0 * track.pace_sigma_m_s(-to_e, to_n) ** 2 + 1e-6
    moving = 0.5 - 0.5 * _STILL
    found, total = [], 0.0
    for prior, (v_n, v_e) in ((_STILL, (0.0, 0.0)), (moving, towards), (moving, across)):
        d_n, d_e = v_n - track.north_m_s, v_e - track.east_m_s
        along, aside = d_n * to_n + d_e * to_e, d_e * to_n - d_n * to_e
        weight = prior * math.exp(-along * along / along_2 - aside * aside / across_2)
        total += weight
        found.append((v_n, v_e, weight))
    if total < 1e-9:
        return []
    return [(v_n, v_e, weight / total) for v_n, v_e, weight in found[1:]]  # still ones are in the grid


def predict_movers(
    tracks: list[Track], nav: NavState, field: ClearanceField, margin_m: float, now_s: float
) -> list[Predicted]:
    """The movers, and the domains ahead of those that are known to move."""
    per_m = 1.0 / field.cell_m
    out = []
    for track in tracks:
        at = track.point(now_s)
        now_m = math.hypot(at.north_m - nav.north_m, at.east_m - nav.east_m)
        touch = min(track.radius_m + HULL * margin_m, 0.9 * now_m) * per_m
        for north_m_s, east_m_s, weight in _hypotheses(track, nav, now_s):
            if weight < _UNLIKELY:
                continue
            leads = ((0.0, touch), (_AHEAD_S, 0.0)) if track.is_likely_mover else ((0.0, touch),)
            for lead_s, hits in leads:
                north, east, domain2 = [], [], []
                for step in range(STEPS):
                    ahead_s = (step + 1) * STEP_S
                    north.append((at.north_m + (ahead_s + lead_s) * north_m_s - field.south_m) * per_m)
                    east.append((at.east_m + (ahead_s + lead_s) * east_m_s - field.west_m) * per_m)
                    sigma_m = min(track.sigma_m(now_s + ahead_s), margin_m) if track.is_likely_mover else 0.0
                    domain2.append(((track.radius_m + margin_m + sigma_m) * per_m) ** 2)
                out.append(
                    Predicted(
                        north, east, hits * hits, domain2, weight if hits else 0.5 * weight, field.cell_m
                    )
                )
    return out
