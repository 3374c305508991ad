"""Followed things, from beams that this file sends itself: a boat that sees discs, still or moving."""

import math
from collections.abc import Callable

import pytest

from companion.core.geo import Point
from companion.obstacles.perception.occupancy import Beam
from companion.obstacles.perception.tracks import ObstacleTracks
from sitl.world.sensors.sampling import generator

WIDTH_RAD = math.radians(15.0)
RADIUS_M = 0.4
Path = Callable[[float], Point]


def sweep_rad(number: int) -> float:
    """To and fro over 180° in steps of 15°."""
    step = number % 24
    return math.radians(-90.0 + 15.0 * (step if step <= 12 else 24 - step))


def echo_m(eye: Point, bearing_rad: float, centre: Point) -> float:
    """What a beam hears of a disc: the nearest of three rays."""
    nearest = math.inf
    for side in (-1.0, 0.0, 1.0):
        ray = bearing_rad + 0.5 * side * WIDTH_RAD
        north, east = centre.north_m - eye.north_m, centre.east_m - eye.east_m
        along = north * math.cos(ray) + east * math.sin(ray)
        across = east * math.cos(ray) - north * math.sin(ray)
        if along > 0.0 and abs(across) < RADIUS_M:
            nearest = min(nearest, along - math.sqrt(RADIUS_M**2 - across**2))
    return nearest if nearest <= 4.0 else math.inf


def follow(thing: Path, boat: Path, seconds: float, seed: int = 1) -> tuple[ObstacleTracks, list[bool]]:
    """Look out for so long; the tracks, and whether anything was taken for a mover at each look."""
    tracks, noise = ObstacleTracks(1.0), generator(seed, "tracks")
    moved = []
    for number in range(round(seconds / 0.06)):
        now_s = 0.06 * number
        eye, bearing = boat(now_s), sweep_rad(number)
        range_m = echo_m(eye, bearing, thing(now_s)) + noise.gauss(0.0, 0.01)
        beam = Beam(now_s, eye, bearing, WIDTH_RAD, range_m, 4.0)
        tracks.add(beam)
        moved.append(bool(tracks.movers(now_s)))
    return tracks, moved


def still(north_m: float, east_m: float) -> Path:
    return lambda now_s: Point(north_m, east_m)


def moving(north_m: float, east_m: float, north_m_s: float, east_m_s: float) -> Path:
    return lambda now_s: Point(north_m + north_m_s * now_s, east_m + east_m_s * now_s)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("east_m", [-2.0, 0.9])
def test_a_rock_that_the_boat_sails_past_stands_still(east_m: float, seed: int) -> None:
    _, moved = follow(still(4.0, east_m), moving(0.0, 0.0, 0.9, 0.0), 6.0, seed)
    assert not any(moved)


def test_what_comes_towards_a_boat_at_rest_moves_and_approaches() -> None:
    tracks, moved = follow(moving(4.4, 0.0, -0.5, 0.0), still(0.0, 0.0), 5.0)
    assert moved[-1]
    (mover,) = tracks.movers(5.0)
    assert mover.north_m_s == pytest.approx(-0.5, abs=3.0 * max(mover.speed_sigma_m_s, 0.05))
    assert mover.closing_m_s(Point(0.0, 0.0), 0.0, 0.0, 5.0) > 0.3
    assert mover.distance_m(Point(0.0, 0.0), 5.0) == pytest.approx(4.4 - 2.5 - RADIUS_M, abs=0.3)


@pytest.mark.parametrize(
    ("thing", "boat"),
    [
        (moving(3.8, -0.5, -0.6, 0.1), still(0.0, 0.0)),
        (still(3.0, 1.0), moving(0.0, 0.0, 0.5, 0.0)),
        (moving(2.0, -3.0, 0.0, 0.8), moving(0.0, 0.0, 0.3, 0.1)),
    ],
)
@pytest.mark.parametrize("origin", [(40.0, -60.0)])
def test_tracks_know_no_origin(thing: Path, boat: Path, origin: tuple[float, float]) -> None:
    def moved(path: Path) -> Path:
        return lambda now_s: Point(path(now_s).north_m + origin[0], path(now_s).east_m + origin[1])

    here, movers_here = follow(thing, boat, 8.0)
    there, movers_there = follow(moved(thing), moved(boat), 8.0)
    assert movers_there == movers_here
    assert len(here.all) == len(there.all) > 0
    for one, other in zip(here.all, there.all, strict=True):
        at = one.point(8.0)
        expected = (at.north_m + origin[0], at.east_m + origin[1])
        assert other.point(8.0) == pytest.approx(expected, abs=1e-6)
        assert (other.north_m_s, other.east_m_s) == pytest.approx((one.north_m_s, one.east_m_s), abs=1e-6)
        assert other.radius_m == pytest.approx(one.radius_m, abs=1e-6)
        assert (other.observations, other.isolated_count) == (one.observations, one.isolated_count)


@pytest.mark.parametrize(("unseen_s", "is_another"), [(1.4, False), (1.6, True)])
def test_a_single_echo_is_forgotten_after_a_sweep_and_gives_no_speed_to_the_next(
    unseen_s: float, is_another: bool
) -> None:
    tracks = ObstacleTracks(1.0)
    for start_s, range_m in ((0.0, 3.5), (unseen_s, 3.0)):
        for number, heard_m in enumerate((math.inf, range_m, math.inf)):
            time_s, bearing = start_s + 0.06 * number, (number - 1) * WIDTH_RAD
            tracks.add(Beam(time_s, Point(0.0, 0.0), bearing, WIDTH_RAD, heard_m, 4.0))
    assert len(tracks.all) == 1
    assert (tracks.all[0].observations == 1) is is_another


@pytest.mark.parametrize(("looks", "is_kept"), [(1, True), (2, False)])
def test_a_single_echo_that_two_looks_refute_is_no_track(looks: int, is_kept: bool) -> None:
    """The next false echo must not make a mover of it."""
    tracks, here = ObstacleTracks(1.0), Point(0.0, 0.0)
    tracks.add(Beam(0.0, here, 0.0, WIDTH_RAD, 2.0, 4.0))
    tracks.add(Beam(0.06, here, 0.3, WIDTH_RAD, math.inf, 4.0))  # beside it: refutes nothing
    for look in range(looks):
        tracks.add(Beam(0.12 + 0.06 * look, here, 0.03, WIDTH_RAD, math.inf, 4.0))
    assert bool(tracks.all) is is_kept
