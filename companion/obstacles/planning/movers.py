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
"""

import math
from typing import Final, NamedTuple

from companion.core.geo import Point
from companion.core.state import NavState
from companion.core.units import clamp
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.motion import STEP_S, STEPS

_SPREAD: Final = 0.25  # of margin², most of Σ: by then the boat has seen more
_UNLIKELY: Final = 0.05
_SIGMAS: Final = 2.0  # 95 %; a new echo may come at 1 m/s
_FAR: Final = 8.0  # four standard deviations


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
    total = 0.0
    norths_m, easts_m, peak, north2, cross, east2, wanders2, width, _ = mover
    last_n = last_e = 0.0
    for step in range(len(norths)):
        north, east = norths[step] - norths_m[step], easts[step] - easts_m[step]
        away = north2[step] * north * north + cross[step] * north * east + east2[step] * east * east
        if step and away < _FAR:
            d_n, d_e = north - last_n, east - last_e
            total += peak[step] * math.exp(-away) * math.sqrt(d_n * d_n + d_e * d_e + wanders2)
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
    per_m = 1.0 / field.cell_m
    found = []
    for track in tracks:
        weight = moves_probability(track, still_count)
        if weight < _UNLIKELY:
            continue
        radius_m = track.radius_m + clear_m
        wanders = track.speed_sigma_m_s * STEP_S * per_m
        one = Predicted([], [], [], [], [], [], wanders * wanders, 2.0 * radius_m * per_m, weight)
        v_n, v_e = worst_velocity(track, nav, wanted_m_s, now_s)
        at = track.point(now_s)
        off_n, off_e = at.north_m - nav.north_m, at.east_m - nav.east_m
        beyond = track.radius_m / max(math.hypot(off_n, off_e), 1e-6)  # echoes come from its near side
        at = Point(at.north_m + beyond * off_n, at.east_m + beyond * off_e)
        for step in range(STEPS):
            ahead_s = (step + 1) * STEP_S
            nn, ne, ee = track.covariance(now_s + ahead_s)
            share = min(1.0, _SPREAD * margin_m * margin_m / (nn + ee))
            nn = share * nn + 0.25 * radius_m * radius_m
            ee = share * ee + 0.25 * radius_m * radius_m
            ne = share * ne
            size = nn * ee - ne * ne
            share = 0.5 * field.cell_m * field.cell_m / size
            soon = 1.0 - 0.5 * step / STEPS
            one.north.append((at.north_m + ahead_s * v_n - field.south_m) * per_m)
            one.east.append((at.east_m + ahead_s * v_e - field.west_m) * per_m)
            one.peak.append(weight * soon * 0.5 * radius_m * radius_m / math.sqrt(size))
            one.north2.append(share * ee)
            one.cross.append(-2.0 * share * ne)
            one.east2.append(share * nn)
        found.append(one)
    return found
