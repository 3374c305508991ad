"""The occupancy grid: the evidence of its cells in figures, and what holds for any beams."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import Point, distance_m
from companion.obstacles.perception.occupancy import MAX_CELLS, SUSPECT, SWEEP_S, Beam, Cell, Occupancy

HERE = Point(0.0, 0.0)
WIDTH_RAD = math.radians(15.0)
FREE = math.inf
ROCK = Point(3.1, 0.1)  # the centre of a cell


def look(range_m: float, time_s: float = 0.0, bearing_rad: float = 0.0, width_rad: float = WIDTH_RAD) -> Beam:
    return Beam(time_s, HERE, bearing_rad, width_rad, range_m, 4.0)


def grid(*beams: Beam) -> Occupancy:
    found = Occupancy(0.2)
    for beam in beams:
        found.add(beam)
    return found


@pytest.mark.parametrize(
    ("bearing_rad", "cells"),
    [
        (0.0, {(3.9, -0.3), (3.9, -0.1), (3.9, 0.1), (3.9, 0.3)}),  # ±0.36 m, of 0.7 of the beam
        (0.5 * math.pi, {(-0.3, 3.9), (-0.1, 3.9), (0.1, 3.9), (0.3, 3.9)}),
        (math.pi, {(-3.9, -0.3), (-3.9, -0.1), (-3.9, 0.1), (-3.9, 0.3)}),
    ],
)
def test_an_echo_marks_the_cells_across_the_core_of_its_beam(
    bearing_rad: float, cells: set[tuple[float, float]]
) -> None:
    found = grid(look(3.95, 0.0, bearing_rad)).obstacles(SUSPECT)
    assert {(round(at.north_m, 6), round(at.east_m, 6)) for at in found} == cells


def test_evidence_grows_by_one_an_echo_up_to_four_and_stays() -> None:
    seen = grid(look(3.1))
    assert seen.evidence_at(ROCK) == 1.0
    seen.add(look(3.1, 1.0))
    assert seen.evidence_at(ROCK) == 2.0
    for number in range(8):
        seen.add(look(3.1, 1.1 + 0.1 * number))
    assert seen.evidence_at(ROCK) == 4.0
    seen.forget(HERE, 5.0, 3600.0)
    assert ROCK in [Point(round(at.north_m, 6), round(at.east_m, 6)) for at in seen.obstacles()]
    assert seen.evidence_at(Point(3.1, 3.1)) is None


def test_what_was_seen_through_is_doubted_down_to_minus_one() -> None:
    seen = grid(look(3.1))
    seen.add(look(3.9, 1.0))
    assert seen.evidence_at(ROCK) == 0.0
    seen.add(look(FREE, 2.0))
    assert seen.evidence_at(ROCK) == -0.5
    seen.add(look(3.9, 3.0))
    assert seen.evidence_at(ROCK) == -1.0


@pytest.mark.parametrize(("aside_m", "is_cleared"), [(0.45, True), (0.55, False)])
def test_the_way_of_what_moves_is_cleared(aside_m: float, *, is_cleared: bool) -> None:
    seen = grid(look(3.1), look(3.1, 0.1))
    (at,) = [cell for cell in seen.obstacles() if distance_m(cell, ROCK) < 0.01]
    west_m = at.east_m - aside_m
    seen.clear_way(Point(at.north_m - 2.0, west_m), Point(at.north_m + 2.0, west_m), 0.5, 0.2)
    assert (seen.evidence_at(at) == -0.5) is is_cleared
    assert (at in [cell.at for cell in seen.seen_since(0.15)]) is is_cleared
    seen.clear_way(Point(9.0, 9.0), at, 0.5, 0.3)
    assert (seen.evidence_at(at) or 0.0) < 0.0


@pytest.mark.parametrize(
    ("range_m", "is_seen_through"), [(3.38, True), (3.22, False), (FREE, True), (0.1, False)]
)
def test_a_beam_clears_up_to_a_cell_before_its_echo(range_m: float, is_seen_through: bool) -> None:
    seen = grid(look(3.1, width_rad=0.01))
    seen.add(look(range_m, 1.0, 0.03, 0.2))
    evidence = seen.evidence_at(ROCK)
    assert evidence is not None
    assert (evidence < 0.6) is is_seen_through


@pytest.mark.parametrize(
    ("off_rad", "is_cleared"),
    [(0.0, True), (0.12, True), (-0.12, True), (0.14, False), (-0.14, False), (3.1, False)],
)
@pytest.mark.parametrize("range_m", [0.5, 3.1])
def test_a_beam_without_an_echo_clears_solid_cells_in_its_whole_width(
    off_rad: float, is_cleared: bool, range_m: float
) -> None:
    for at in grid(look(range_m, width_rad=0.01)).obstacles(SUSPECT):
        other = grid(look(range_m, width_rad=0.01), look(range_m, 0.1, width_rad=0.01))
        other.add(look(FREE, 0.1, math.atan2(at.east_m, at.north_m) + off_rad))  # half its width: 0.131 rad
        assert (other.evidence_at(at) == 1.5) is is_cleared


@pytest.mark.parametrize(("off_rad", "is_cleared"), [(0.08, True), (0.1, False)])
def test_a_beam_with_an_echo_beyond_clears_solid_cells_in_its_core_alone(
    off_rad: float, is_cleared: bool
) -> None:
    seen = grid(look(3.1, width_rad=0.01), look(3.1, 0.1, width_rad=0.01))
    at = math.atan2(ROCK.east_m, ROCK.north_m)
    seen.add(look(3.9, 0.2, at + off_rad))  # half of the core: 0.092 rad
    assert (seen.evidence_at(ROCK) == 1.0) is is_cleared


@pytest.mark.parametrize(
    ("off_m", "is_cleared"),
    [(0.0, True), (0.52, True), (-0.52, True), (0.57, False), (-0.57, False)],
)
def test_a_beam_clears_suspect_cells_of_which_a_corner_is_in_it(off_m: float, is_cleared: bool) -> None:
    seen = grid(
        look(3.1, width_rad=0.01)
    )  # half of the width: 0.40 m there; half of a cell's diagonal: 0.14 m
    at = math.atan2(ROCK.east_m, ROCK.north_m) + math.asin(off_m / 3.1)
    seen.add(look(FREE, 0.0, at))
    assert (seen.evidence_at(ROCK) == 0.5) is is_cleared


def test_beside_a_solid_cell_a_beam_clears_only_what_it_covers() -> None:
    rock = look(2.1, 0.0, math.pi, 0.01)
    seen = grid(rock, look(2.1, 0.1, math.pi, 0.01), look(3.1, 0.1, width_rad=0.01))
    seen.add(look(FREE, 0.1, math.atan2(ROCK.east_m, ROCK.north_m) + 0.14))
    assert seen.evidence_at(ROCK) == 1.0


@pytest.mark.parametrize("range_m", [0.7, 1.5, 2.3, 3.1])
@pytest.mark.parametrize("turned_rad", [0.0, 0.02, -0.02])
def test_a_second_look_at_the_place_of_a_single_echo_leaves_no_suspect(
    range_m: float, turned_rad: float
) -> None:
    for number in range(24):
        bearing = number * math.pi / 12.0 + 0.03
        seen = grid(look(range_m, 0.0, bearing))
        seen.add(look(FREE, 0.12, bearing + turned_rad))  # the boat has turned by a degree
        assert seen.obstacles(SUSPECT) == []


@pytest.mark.parametrize(("range_m", "evidence"), [(3.3, 2.0), (2.9, 2.0), (3.5, 1.0)])
def test_an_echo_in_a_neighbouring_cell_counts_as_a_second_look(range_m: float, evidence: float) -> None:
    seen = grid(look(3.1, width_rad=0.01))
    seen.add(look(range_m, 0.1, 0.02, 0.01))
    assert seen.evidence_at(Point(range_m, 0.02 * range_m)) == pytest.approx(evidence)


@pytest.mark.parametrize(
    ("at", "now_s", "is_kept"),
    [
        (HERE, 2.9, True),
        (HERE, 3.1, False),  # one look alone
        (Point(-1.7, 0.0), 0.1, True),
        (Point(-2.1, 0.0), 0.1, False),
        (Point(0.0, 4.8), 0.1, True),
        (Point(0.0, 5.2), 0.1, False),
        (Point(0.0, -5.2), 0.1, False),
    ],
)
def test_cells_are_forgotten_by_age_and_distance(at: Point, now_s: float, is_kept: bool) -> None:
    seen = grid(look(3.1, width_rad=0.001))
    seen.forget(at, 5.0, now_s)
    assert (len(seen) > 0) is is_kept


@given(
    st.lists(
        st.tuples(
            st.floats(-7.0, 7.0),
            st.just(FREE) | st.floats(0.02, 4.0),
            st.floats(-99.0, 99.0),
            st.floats(0.01, 3.0),
        ),
        max_size=80,
    )
)
def test_memory_is_bounded_and_every_thing_was_within_reach(
    looks: list[tuple[float, float, float, float]],
) -> None:
    seen = Occupancy(0.05)
    for number, (bearing, range_m, north_m, width) in enumerate(looks):
        seen.add(Beam(0.06 * number, Point(north_m, 0.0), bearing, width, range_m, 4.0))
    assert len(seen) <= MAX_CELLS
    for thing in seen.obstacles(SUSPECT):
        assert min(distance_m(Point(north_m, 0.0), thing) for _, _, north_m, _ in looks) < 4.0 + 0.1


class Exhaustive(Occupancy):
    """Each beam visits all cells."""

    def _within(self, beam: Beam, length_m: float, half_m: float) -> list[Cell]:
        return list(self._cells.values())


def state(seen: Occupancy) -> list[tuple[Point, float, float, float]]:
    return [(one.at, one.evidence, one.seen_s, one.solid_s) for one in seen.seen_since(-math.inf)]


@given(
    st.floats(0.02, 0.5),
    st.lists(
        st.tuples(
            st.builds(Point, st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)),
            st.floats(-7.0, 7.0),
            st.floats(0.01, 0.3) | st.floats(0.01, math.tau),
            st.just(FREE) | st.floats(0.02, 4.0),
            st.booleans(),
        ),
        max_size=60,
    ),
)
def test_a_beam_that_visits_the_blocks_near_it_equals_one_that_visits_all_cells(
    cell_m: float, looks: list[tuple[Point, float, float, float, bool]]
) -> None:
    seen, other = Occupancy(cell_m), Exhaustive(cell_m)
    for number, (at, bearing, width, range_m, is_late) in enumerate(looks):
        beam = Beam(0.1 * number, at, bearing, width, range_m, 4.0, 0.2)
        assert seen.add(beam) is other.add(beam)
        for one in (seen, other) if is_late else ():
            one.forget(at, 5.0, beam.time_s)
            one.restore(at, beam.time_s)
        assert state(seen) == state(other)
    assert sum(map(len, seen._blocks.values())) == len(seen)


def test_the_oldest_cell_leaves_its_block_too() -> None:
    seen = Occupancy(0.2)
    for number in range(MAX_CELLS + 9):
        seen.restore(Point(0.2 * (number + 0.5), 0.0), 0.0)
    assert sum(map(len, seen._blocks.values())) == len(seen) == MAX_CELLS
    assert seen.evidence_at(Point(0.1, 0.1)) is None


def test_the_map_knows_no_origin() -> None:
    here, there = grid(), grid()
    for number in range(200):
        bearing, range_m = 0.3 * number, (1.0 + 0.013 * number if number % 3 else FREE)
        for seen, north_m, east_m in ((here, 0.003, -0.001), (there, 40.003, -60.001)):
            at = Point(north_m + 0.01 * number, east_m - 0.007 * number)
            seen.add(Beam(100.0 + 0.1 * number, at, bearing, WIDTH_RAD, range_m, 4.0))
    for least in (SUSPECT, 1.0):
        one, other = (sorted(seen.obstacles(least)) for seen in (here, there))
        assert [Point(n - 40.0, e + 60.0) for n, e in other] == [pytest.approx(at, abs=0.02) for at in one]
        assert one


CLOSE = Point(0.7, 0.1)


def test_an_echo_close_by_where_nothing_was_seen_counts_for_little() -> None:
    seen = grid()
    assert not seen.add(look(0.7))
    assert seen.evidence_at(CLOSE) == pytest.approx(0.3)
    assert not seen.add(look(1.09, 0.1, math.pi))
    assert seen.add(look(1.11, 0.2, 0.5 * math.pi))
    assert seen.evidence_at(Point(0.1, 1.1)) == 1.0


def test_spray_in_one_ping_of_five_never_becomes_an_obstacle() -> None:
    seen = grid()
    for number in range(600):
        seen.add(look(0.7 if number % 5 == 0 else FREE, 0.06 * number))
        assert seen.obstacles(SUSPECT) == []


def test_what_was_seen_farther_off_may_come_close() -> None:
    seen = grid(look(1.3))
    assert seen.add(Beam(1.0, Point(0.6, 0.0), 0.0, WIDTH_RAD, 0.7, 4.0))
    assert seen.evidence_at(Point(1.3, 0.1)) == 2.0
    forgotten = grid(look(1.3))
    forgotten.forget(HERE, 5.0, 3.1)
    assert not forgotten.add(Beam(3.1, Point(0.6, 0.0), 0.0, WIDTH_RAD, 0.7, 4.0))


def test_what_stays_close_by_is_an_obstacle_from_the_fifth_ping() -> None:
    seen = grid()
    believed = [seen.add(look(0.7, 0.06 * number)) for number in range(5)]
    assert believed == [False, False, False, False, True]
    assert CLOSE in [Point(round(at.north_m, 6), round(at.east_m, 6)) for at in seen.obstacles()]


def test_two_beams_of_one_moment_mark_a_cell_once() -> None:
    seen = grid(look(3.1), look(3.1, 0.0, 0.01))
    assert seen.evidence_at(ROCK) == 1.0


def test_what_has_been_solid_for_two_sweeps_stands() -> None:
    seen = grid(look(3.1), look(3.1, 1.0))
    assert seen.standing(1.0 + 2.0 * SWEEP_S) == []
    assert distance_m(seen.standing(1.1 + 2.0 * SWEEP_S)[0], ROCK) < 0.5
    seen.add(look(3.1, 3.0))
    assert seen.standing(1.1 + 2.0 * SWEEP_S)
    for time_s in (3.1, 3.2, 3.3):
        seen.add(look(3.9, time_s))
    assert all(distance_m(at, ROCK) > 0.2 for at in seen.standing(20.0))
    for time_s in (3.4, 3.5, 3.6):
        seen.add(look(3.1, time_s))
    assert all(distance_m(at, ROCK) > 0.2 for at in seen.standing(4.5))


def test_what_is_given_back_from_the_voyage_stands() -> None:
    seen = grid()
    seen.restore(ROCK, 5.0)
    assert seen.standing(5.0) == [ROCK]
