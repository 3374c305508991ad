"""The risk of a collision with what may move.

A track has a velocity v with a covariance; for planning, v is moved by up to two standard deviations towards
a collision course. Its place t from now has the distribution N(p + v t, Σ(t)), and the probability that it is
then within R of the boat is, with a Gaussian in place of the disc,

    P = π R² / (2 π √|S|) exp(−½ dᵀ S⁻¹ d),   S = Σ(t) + R² / 4

(N. E. Du Toit, J. W. Burdick, *Probabilistic collision checking with chance constraints*, IEEE Transactions
on Robotics 27(4), 2011). P times the relative speed over 2 R is the rate of collisions, its sum over the
rollout their expected number. What lies still is in the grid: a track counts with the probability that it
moves, from the density of its velocity at rest after and before the observations (the Savage–Dickey ratio:
J. M. Dickey, Annals of Mathematical Statistics 42, 1971).

A vessel with AIS is an ellipse of its length and beam in place of the disc, and has the velocity that it
reports. It is predicted beyond the end of a rollout, from where the boat goes straight on.
"""

import math
from collections.abc import Iterable, Mapping
from typing import Final, NamedTuple

from companion.core.geo import Point
from companion.core.state import NavState
from companion.core.units import clamp
from companion.obstacles.perception.track import Track
from companion.obstacles.perception.vessels import LOOK_AHEAD_S, Vessel
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.motion import STEP_S, STEPS

_SPREAD: Final = 0.25  # of margin², most of Σ: by then the boat has seen more
_UNLIKELY: Final = 0.05
_SIGMAS: Final = 2.0  # 95 %; a new echo may come at 1 m/s
_FAR: Final = 8.0  # four standard deviations
_TOUCHING: Final = 1e-4  # as near as can be told
_TIMES_S: Final = tuple(STEP_S * (step + 1) for step in range(STEPS))
EVERY: Final = 2  # steps of a rollout at which vessels are looked at
# Its later steps grow by 15 %, the error of a vessel's place by 9 % of its way: within two deviations
VESSEL_S: Final = (*_TIMES_S[EVERY - 1 :: EVERY], *(_TIMES_S[-1] * 1.15**step for step in range(1, 19)))
Spread = tuple[float, float, float]  # north, north and east, east


class Predicted(NamedTuple):
    """By step: place, peak of P, and half the inverse of S, in cells of the field. wanders2: square of the
    distance in a step by which its velocity is uncertain; width: 2 R; weight: probability that it moves.
    """

    north: list[float]
    east: list[float]
    peak: list[float]
    north2: list[float]
    cross: list[float]
    east2: list[float]
    wanders2: float
    width: float
    weight: float


def moves_probability(track: Track, still_count: int) -> float:
    """The probability that a track moves, where so many things in sight do not: 1 / (2 + still_count) before
    it is observed, by Laplace's rule of succession.
    """
    if track.is_mover:
        return 1.0
    return 1.0 / (1.0 + (1.0 + still_count) * track.rest_ratio())


def collision_risk(mover: Predicted, norths: list[float], easts: list[float]) -> float:
    """Expected number of collisions along a rollout, the sooner the more (1 to ½)."""
    total = last_n = last_e = 0.0
    *places, wanders2, width, _ = mover
    steps = zip(norths, easts, *places, strict=False)  # a rollout may break off
    for step, (boat_n, boat_e, its_n, its_e, peak, north2, cross, east2) in enumerate(steps):
        north, east = boat_n - its_n, boat_e - its_e
        away = north2 * north * north + cross * north * east + east2 * east * east
        if step and away < _FAR:
            d_n, d_e = north - last_n, east - last_e
            total += peak * math.exp(-away) * math.sqrt(d_n * d_n + d_e * d_e + wanders2)
        last_n, last_e = north, east
    return total / width


def worst_velocity(
    track: Track, nav: NavState, wanted_m_s: tuple[float, float], now_s: float
) -> tuple[float, float]:
    """The velocity nearest to a collision course with the one that the boat wants, within two standard
    deviations, along the line of sight and across it.
    """
    at = track.point(now_s)
    north, east = nav.north_m - at.north_m, nav.east_m - at.east_m
    away_m = max(math.hypot(north, east), 1e-6)
    to_n, to_e = north / away_m, east / away_m
    along = track.north_m_s * to_n + track.east_m_s * to_e + _SIGMAS * track.pace_sigma_m_s(to_n, to_e)
    across = track.east_m_s * to_n - track.north_m_s * to_e
    most_m_s = _SIGMAS * track.pace_sigma_m_s(-to_e, to_n)
    across += clamp(wanted_m_s[1] * to_n - wanted_m_s[0] * to_e - across, -most_m_s, most_m_s)
    return along * to_n - across * to_e, along * to_e + across * to_n


def predict(
    tracks: list[Track],
    still_count: int,
    nav: NavState,
    wanted_m_s: tuple[float, float],
    field: ClearanceField,
    margin_m: float,
    clear_m: float,
    now_s: float,
) -> list[Predicted]:
    """What may move. wanted_m_s: the boat's velocity over ground on its path; clear_m: distance of a touch
    from the mover's edge.
    """
    found = []
    for track in tracks:
        weight = moves_probability(track, still_count)
        if weight < _UNLIKELY:
            continue
        radius_m = track.radius_m + clear_m
        at = track.point(now_s)
        off_n, off_e = at.north_m - nav.north_m, at.east_m - nav.east_m
        beyond = track.radius_m / max(math.hypot(off_n, off_e), 1e-6)  # echoes come from its near side
        at = Point(at.north_m + beyond * off_n, at.east_m + beyond * off_e)
        spreads: dict[float, Spread] = {}
        for ahead_s in _TIMES_S:
            nn, ne, ee = track.covariance(now_s + ahead_s)
            share = min(1.0, _SPREAD * margin_m * margin_m / (nn + ee))
            disc_m2 = 0.25 * radius_m * radius_m
            spreads[ahead_s] = share * nn + disc_m2, share * ne, share * ee + disc_m2
        velocity, wanders_m = worst_velocity(track, nav, wanted_m_s, now_s), track.speed_sigma_m_s * STEP_S
        found.append(_predicted(at, velocity, spreads, (radius_m, radius_m), field, weight, wanders_m))
    return found


def predict_vessels(
    vessels: Iterable[Vessel],
    nav: NavState,
    wanted_m_s: tuple[float, float],
    field: ClearanceField,
    margin_m: float,
) -> list[Predicted]:
    """What has AIS, with S at the closest approach. margin_m: to keep from its hull.

    Beside a vessel at rest the boat is free: S is smaller there than the error of the position would have it.
    """
    found = []
    for vessel in vessels:
        north, east = vessel.at.north_m - nav.north_m, vessel.at.east_m - nav.east_m
        v_n, v_e = wanted_m_s[0] - vessel.north_m_s, wanted_m_s[1] - vessel.east_m_s
        closest_s = clamp((north * v_n + east * v_e) / max(v_n * v_n + v_e * v_e, 1e-6), 0.0, LOOK_AHEAD_S)
        spread_m2 = vessel.variance_m2(closest_s) + nav.position_sigma_m**2
        length_m, beam_m = vessel.half_length_m + margin_m, vessel.half_beam_m + margin_m
        along_m2, across_m2 = 0.25 * length_m**2 + spread_m2, 0.25 * beam_m**2 + spread_m2
        c, s = math.cos(vessel.heading_rad), math.sin(vessel.heading_rad)
        shrinks = 1.0
        if vessel.is_at_rest:
            here = (north * c + east * s) ** 2 / along_m2 + (east * c - north * s) ** 2 / across_m2
            shrinks = clamp(0.5 * here / _FAR, _TOUCHING, 1.0)
        along_m2, across_m2 = shrinks * along_m2, shrinks * across_m2
        spread = (
            along_m2 * c * c + across_m2 * s * s,
            (along_m2 - across_m2) * c * s,
            along_m2 * s * s + across_m2 * c * c,
        )
        velocity, spreads = (vessel.north_m_s, vessel.east_m_s), dict.fromkeys(VESSEL_S, spread)
        found.append(_predicted(vessel.at, velocity, spreads, (length_m * math.sqrt(shrinks), beam_m), field))
    return found


def _predicted(
    at: Point,
    velocity: tuple[float, float],
    spreads: Mapping[float, Spread],
    half_axes_m: tuple[float, float],
    field: ClearanceField,
    weight: float = 1.0,
    wanders_m: float = 0.0,
) -> Predicted:
    """spreads: S by time from now."""
    (length_m, beam_m), per_m = half_axes_m, 1.0 / field.cell_m
    one = Predicted([], [], [], [], [], [], (wanders_m * per_m) ** 2, 2.0 * beam_m * per_m, weight)
    for ahead_s, (nn, ne, ee) in spreads.items():
        size = nn * ee - ne * ne
        share = 0.5 * field.cell_m * field.cell_m / size
        soon = max(1.0 - 0.5 * (ahead_s - STEP_S) / _TIMES_S[-1], 0.5)
        one.north.append((at.north_m + ahead_s * velocity[0] - field.south_m) * per_m)
        one.east.append((at.east_m + ahead_s * velocity[1] - field.west_m) * per_m)
        one.peak.append(weight * soon * 0.5 * length_m * beam_m / math.sqrt(size))
        one.north2.append(share * ee)
        one.cross.append(-2.0 * share * ne)
        one.east2.append(share * nn)
    return one
