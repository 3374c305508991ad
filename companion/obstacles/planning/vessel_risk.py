"""The risk of a collision with vessels that have AIS.

P is that of `movers.py`, with an ellipse of the vessel's length and beam in place of the disc of R. S is the
covariance of both positions and of the vessel's velocity at the closest approach, and of the ellipse. Along a
straight line P is a Gaussian of the distance travelled, whose integral is known: a rollout is taken as some
straight lines and goes straight on beyond its end, so that a ship beyond its reach is kept clear of. Beside a
vessel at rest the boat is free: there, S is smaller than the error of the position would have it.
"""

import math
from collections.abc import Iterable
from typing import Final, NamedTuple

from companion.core.state import NavState
from companion.core.units import clamp
from companion.obstacles.perception.vessels import LOOK_AHEAD_S, Vessel
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.motion import STEP_S, STEPS

_LINE: Final = 10  # steps: the chord of a turn at cruise is within a metre of it
_LATER: Final = 0.5  # the weight of what happens at the end of a rollout or after it
_FAR: Final = 8.0  # four standard deviations
_TOUCHING: Final = 1e-4  # as near as can be told


class Approach(NamedTuple):
    """north, east: now; north_s, east_s: a second; peak: of P over the beam; north2, cross, east2: half the
    inverse of S. All in cells of the field.
    """

    north: float
    east: float
    north_s: float
    east_s: float
    peak: float
    north2: float
    cross: float
    east2: float


def approaches(
    vessels: Iterable[Vessel],
    nav: NavState,
    wanted_m_s: tuple[float, float],
    field: ClearanceField,
    margin_m: float,
) -> list[Approach]:
    """margin_m: to keep from their hulls. wanted_m_s: the boat's velocity over ground on its path."""
    cell_m, found = field.cell_m, []
    for one in vessels:
        off_n, off_e = one.at.north_m - nav.north_m, one.at.east_m - nav.east_m
        v_n, v_e = wanted_m_s[0] - one.north_m_s, wanted_m_s[1] - one.east_m_s
        closest_s = (off_n * v_n + off_e * v_e) / max(v_n * v_n + v_e * v_e, 1e-6)
        spread_m2 = one.variance_m2(clamp(closest_s, 0.0, LOOK_AHEAD_S)) + nav.position_sigma_m**2
        half_length_m, half_beam_m = one.half_length_m + margin_m, one.half_beam_m + margin_m
        along_m2, across_m2 = 0.25 * half_length_m**2 + spread_m2, 0.25 * half_beam_m**2 + spread_m2
        c, s = math.cos(one.heading_rad), math.sin(one.heading_rad)
        peak = 0.5 * half_length_m * half_beam_m / math.sqrt(along_m2 * across_m2)
        here = 0.5 * ((off_n * c + off_e * s) ** 2 / along_m2 + (off_e * c - off_n * s) ** 2 / across_m2)
        shrinks = max(_FAR / max(here, _TOUCHING), 1.0) if one.is_at_rest else 1.0
        along, across = (0.5 * shrinks * cell_m**2 / one_m2 for one_m2 in (along_m2, across_m2))
        found.append(
            Approach(
                (one.at.north_m - field.south_m) / cell_m,
                (one.at.east_m - field.west_m) / cell_m,
                one.north_m_s / cell_m,
                one.east_m_s / cell_m,
                peak * math.sqrt(shrinks) * cell_m / (2.0 * half_beam_m),
                along * c * c + across * s * s,
                2.0 * (along - across) * c * s,
                along * s * s + across * c * c,
            )
        )
    return found


def approach_risk(vessel: Approach, norths: list[float], easts: list[float]) -> float:
    """Expected number of collisions along a rollout and straight on, the sooner the more (1 to ½)."""
    last, total = len(norths) - 1, 0.0
    from_n = from_e = 0.0
    for step in (*range(0, last, _LINE), last):
        time_s = (step + 1) * STEP_S
        north = norths[step] - vessel.north - time_s * vessel.north_s
        east = easts[step] - vessel.east - time_s * vessel.east_s
        if step:
            soon = 1.0 - (1.0 - _LATER) * step / STEPS
            total += soon * _on_line(vessel, from_n, from_e, north - from_n, east - from_e)
        from_n, from_e = north, east
    if last:
        onward_s = LOOK_AHEAD_S - (last + 1) * STEP_S
        v_n = (norths[-1] - norths[-2]) / STEP_S - vessel.north_s
        v_e = (easts[-1] - easts[-2]) / STEP_S - vessel.east_s
        total += _LATER * _on_line(vessel, from_n, from_e, onward_s * v_n, onward_s * v_e)
    return total


def _on_line(vessel: Approach, north: float, east: float, way_n: float, way_e: float) -> float:
    """The integral of P over the beam along a way from a place, both relative to the vessel."""
    n2, ne, e2 = vessel.north2, vessel.cross, vessel.east2
    a = n2 * way_n * way_n + ne * way_n * way_e + e2 * way_e * way_e
    b = n2 * way_n * north + 0.5 * ne * (way_n * east + way_e * north) + e2 * way_e * east
    away = n2 * north * north + ne * north * east + e2 * east * east
    if a < 1e-9:  # they keep their distance
        return 0.0
    if (nearest := away - b * b / a) >= _FAR:
        return 0.0
    root, past = math.sqrt(a), b / math.sqrt(a)
    share = math.erf(root + past) - math.erf(past)
    return (
        vessel.peak * math.hypot(way_n, way_e) * math.exp(-nearest) * 0.5 * math.sqrt(math.pi) / root * share
    )
