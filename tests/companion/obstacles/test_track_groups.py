"""How the echoes of one sweep become an observation: literal beams, from any direction."""

import math
from collections.abc import Sequence

import pytest

from companion.core.geo import Point
from companion.obstacles.perception.occupancy import Beam
from companion.obstacles.perception.track import Track
from companion.obstacles.perception.tracks import MAX_TRACKS, ObstacleTracks

WIDTH_RAD = 0.25  # also the angle between neighbouring beams
STEP_S = 0.06
FREE = math.inf
HERE = Point(40.0, -30.0)


class Sweep:
    """Beams of one ranger, each a width to starboard of the one before."""

    def __init__(self, bow_rad: float = 0.0, scale_m: float = 1.0) -> None:
        self.tracks = ObstacleTracks(scale_m)
        self.bow_rad, self.now_s = bow_rad, 0.0

    def look(self, bearing_rad: float, range_m: float, after_s: float = STEP_S, at: Point = HERE) -> None:
        self.now_s += after_s
        beam = Beam(self.now_s, at, self.bow_rad + bearing_rad, WIDTH_RAD, range_m, 10.0)
        self.tracks.add(beam)

    def over(self, ranges_m: Sequence[float], first_rad: float = -WIDTH_RAD) -> list[Track]:
        for number, range_m in enumerate(ranges_m):
            self.look(first_rad + number * WIDTH_RAD, range_m)
        return self.tracks.all

    def place(self, bearing_rad: float, range_m: float) -> Point:
        angle = self.bow_rad + bearing_rad
        return Point(HERE.north_m + range_m * math.cos(angle), HERE.east_m + range_m * math.sin(angle))


@pytest.mark.parametrize("bow_rad", [0.0, -2.0])
@pytest.mark.parametrize(
    ("ranges_m", "bearing_rad", "range_m", "radius_m", "seen"),
    [
        ([FREE, 3.0, FREE], 0.0, 3.0, 0.3, 1),  # half a beam at 3 m is 0.375 m across: the least radius
        ([FREE, 6.0, FREE], 0.0, 6.0, 0.375, 1),
        ([FREE, 3.0, 3.1, FREE], 0.125, 3.0, 0.375, 1),
        ([FREE, 3.5, 3.0, FREE], 0.125, 3.0, 0.375, 2),
        ([FREE, 3.0, 3.59, FREE], 0.125, 3.0, 0.375, 1),
        ([FREE, 2.6, 2.6, 2.6, 2.6, FREE], 0.375, 2.6, 0.975, 1),  # 0.75 × 2.6 = 1.95 m
    ],
)
def test_an_obstacle_lies_at_the_nearest_range_in_the_middle_of_its_echoes(
    bow_rad: float, ranges_m: list[float], bearing_rad: float, range_m: float, radius_m: float, seen: int
) -> None:
    sweep = Sweep(bow_rad)
    (track,) = sweep.over(ranges_m)
    assert track.point(0.0) == pytest.approx(sweep.place(bearing_rad, range_m), abs=1e-6)
    assert track.radius_m == pytest.approx(radius_m)
    assert track.seen_s == pytest.approx(STEP_S * (1 + seen))
    assert (track.number, track.observations) == (1, 1)
    assert (track.isolated_count, track.whole_count) == (1, 1)


def test_the_radius_is_between_three_tenths_of_the_scale_and_the_scale() -> None:
    (small,) = Sweep(scale_m=2.0).over([FREE, 3.0, FREE])
    assert small.radius_m == pytest.approx(0.6)
    tracks = ObstacleTracks(1.0)
    for bearing_rad, range_m in ((-1.0, FREE), (0.0, 6.0), (1.0, FREE)):
        tracks.add(Beam(0.06 * bearing_rad, HERE, bearing_rad, 1.0, range_m, 10.0))
    assert tracks.all[0].radius_m == pytest.approx(1.0), "1.5 m by the width of the beam"


@pytest.mark.parametrize(
    ("ranges_m", "counts"),
    [
        ([FREE, 3.0, 3.61, FREE], [0, 0]),  # two obstacles, 1.0 m apart: neither is isolated
        ([FREE, 3.0, 5.0, FREE], [1, 0]),  # 2.2 m apart: water is free beside the nearer one
        ([FREE, 5.0, 3.0, FREE], [0, 1]),
        ([FREE, 3.0, 4.2, FREE], [0, 0]),  # 1.49 m
        ([FREE, 3.0, 4.3, FREE], [1, 0]),  # 1.58 m
    ],
)
def test_an_isolated_obstacle_has_free_water_on_either_side(ranges_m: list[float], counts: list[int]) -> None:
    found = Sweep().over(ranges_m)
    assert [track.isolated_count for track in found] == counts
    assert [track.whole_count for track in found] == [1, 1]
    assert [track.number for track in found] == [1, 2]


@pytest.mark.parametrize("end", ["first beam", "late before", "far before", "turned back"])
def test_an_obstacle_at_the_end_of_a_sweep_is_cut_off(end: str) -> None:
    sweep = Sweep()
    if end == "late before":
        sweep.look(-0.25, FREE)
        sweep.look(0.0, 3.0, after_s=0.41)
    elif end == "far before":
        sweep.look(-0.38, FREE)  # more than one and a half widths
        sweep.look(0.0, 3.0)
    elif end == "turned back":
        sweep.look(-0.25, FREE)
        sweep.look(0.0, 3.0)
        sweep.look(0.25, 3.0)
        sweep.look(0.0, FREE)
    else:
        sweep.look(0.0, 3.0)
    sweep.look(0.25, FREE)
    (track,) = sweep.tracks.all
    assert (track.whole_count, track.isolated_count) == (0, 0)


@pytest.mark.parametrize(("after_rad", "after_s"), [(0.38, STEP_S), (0.25, 0.41), (0.02, STEP_S)])
def test_without_a_neighbour_behind_it_nothing_is_isolated(after_rad: float, after_s: float) -> None:
    sweep = Sweep()
    sweep.look(-0.25, FREE)
    sweep.look(0.0, 3.0)
    sweep.look(after_rad, FREE, after_s=after_s)
    assert (sweep.tracks.all[0].isolated_count, sweep.tracks.all[0].whole_count) == (0, 1)


def sigmas_m(track: Track) -> tuple[float, float]:
    """Standard deviations north and east of a track."""
    at = track.point(track.seen_s)
    north = Point(at.north_m + 1.0, at.east_m)
    east = Point(at.north_m, at.east_m + 1.0)
    return 1.0 / track.deviation_sigmas(north, 1.0, 0.0, 0.0), 1.0 / track.deviation_sigmas(
        east, 0.0, 1.0, 0.0
    )


@pytest.mark.parametrize(("bow_rad", "is_east"), [(0.0, False), (0.5 * math.pi, True), (math.pi, False)])
def test_an_obstacle_is_known_well_along_the_beam_and_poorly_across(bow_rad: float, is_east: bool) -> None:
    across_m = 2.0 * 3.0 * WIDTH_RAD / math.sqrt(12.0)
    expected = (across_m, 0.05) if is_east else (0.05, across_m)
    sweep = Sweep(bow_rad)
    sweep.over([FREE, 3.0, FREE])
    assert sigmas_m(sweep.tracks.all[0]) == pytest.approx(expected, rel=2e-3)
    sweep.over([FREE, 3.0, FREE])
    # Meanwhile 0.18 s passed, with a speed that is known to 0.5 m/s
    both = [math.sqrt(1.0 / (1.0 / (one**2 + 0.25 * 0.18**2) + 1.0 / one**2)) for one in expected]
    assert sigmas_m(sweep.tracks.all[0]) == pytest.approx(both, rel=1e-2)
    assert sweep.tracks.all[0].isolated_count == 2


def test_an_obstacle_that_is_cut_off_is_located_along_the_beam_only() -> None:
    sweep = Sweep()
    sweep.over([FREE, 3.0, FREE])
    _, first_m = sigmas_m(sweep.tracks.all[0])
    sweep.look(0.0, 3.0, after_s=1.0)
    sweep.look(0.25, FREE)
    (track,) = sweep.tracks.all
    north_m, east_m = sigmas_m(track)
    assert (track.observations, track.whole_count) == (2, 1)
    assert east_m > first_m
    assert north_m < 0.051


def test_of_two_tracks_the_nearer_one_is_observed() -> None:
    sweep = Sweep()
    sweep.over([FREE, 3.0, FREE])
    sweep.over([FREE, 3.9, FREE])
    assert len(sweep.tracks.all) == 2
    far = sweep.over([FREE, 3.75, FREE])[1]
    assert far.observations == 2
    near = sweep.over([FREE, 3.1, FREE])[0]
    assert (near.observations, far.observations) == (2, 2)


def test_the_track_that_was_not_seen_for_longest_makes_room() -> None:
    sweep = Sweep()
    for number in range(MAX_TRACKS + 1):
        at = Point(20.0 * number, 0.0)
        for bearing_rad, range_m in ((-0.25, FREE), (0.0, 3.0), (0.25, FREE)):
            sweep.look(bearing_rad, range_m, 0.02, at=at)
    assert [track.number for track in sweep.tracks.all] == list(range(2, MAX_TRACKS + 2))


def test_tracks_are_known_movers_or_may_be() -> None:
    tracks = ObstacleTracks(1.0)
    once, rock, probable, mover = (Track(number, 10.0, HERE, 0.3) for number in range(4))
    for track in (rock, probable, mover):
        track.observations = track.whole_count = 2
        track.evidence = 2.0
    mover.is_mover, probable.isolated_count = True, 1
    tracks.all = [once, rock, probable, mover]
    assert tracks.known(10.0) == [rock, probable, mover]
    assert tracks.movers(10.0) == [mover]
    once.isolated_count = 1
    assert tracks.possible_movers(11.4, in_open_water=True) == [probable, mover], "a single echo may be false"
    assert tracks.possible_movers(11.4, in_open_water=False) == [once, probable, mover]
    probable.evidence = 1.0
    assert tracks.possible_movers(11.4, in_open_water=True) == [mover], "two beams met nothing there"
    tracks.all.append(once)
    assert tracks.possible_movers(11.6, in_open_water=True) == [mover]
    assert tracks.known(14.49) == [rock, probable, mover]
    rock.seen_s = 11.0
    assert tracks.known(14.51) == [rock]
    assert tracks.all == [rock]


@pytest.mark.parametrize(("unseen_s", "observations"), [(1.4, 2), (1.6, 1)])
def test_a_single_echo_is_forgotten_after_a_sweep_and_gives_no_speed_to_the_next(
    unseen_s: float, observations: int
) -> None:
    sweep = Sweep()
    sweep.over([FREE, 3.5, FREE])
    sweep.now_s += unseen_s - 3.0 * STEP_S
    (track,) = sweep.over([FREE, 3.0, FREE])
    assert track.observations == observations


@pytest.mark.parametrize(("looks", "is_kept"), [(1, True), (2, False)])
def test_a_single_echo_that_two_looks_refute_is_no_track(looks: int, is_kept: bool) -> None:
    """The next false echo must not make a mover of it."""
    sweep = Sweep()
    sweep.look(0.0, 2.0)
    sweep.look(0.3, FREE)  # beside it: refutes nothing
    for _ in range(looks):
        sweep.look(0.03, FREE)
    assert bool(sweep.tracks.all) is is_kept
