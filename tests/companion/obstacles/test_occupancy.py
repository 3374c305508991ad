import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import Point, distance_m
from companion.obstacles.perception.occupancy import MAX_CELLS, SOLID, SUSPECT, Beam, Occupancy

HERE = Point(0.0, 0.0)
WIDTH_RAD = math.radians(15.0)


def look(
    range_m: float, time_s: float, bearing_rad: float = 0.0, at: Point = HERE, reach_m: float = 4.0
) -> Beam:
    return Beam(time_s, at, bearing_rad, WIDTH_RAD, range_m, reach_m)


def water() -> Occupancy:
    return Occupancy(0.2, 25.0)


def test_one_echo_makes_a_suspect_and_a_second_one_makes_it_solid() -> None:
    seen = water()
    seen.add(look(3.0, 0.0))
    assert seen.obstacles(0.0) == []
    assert seen.obstacles(0.0, SUSPECT)
    seen.add(look(3.05, 0.72))
    solid = seen.obstacles(0.72)
    assert solid
    assert all(abs(distance_m(HERE, thing) - 3.0) < 0.3 for thing in solid)


def test_echoes_of_spray_here_and_there_never_become_solid() -> None:
    seen = water()
    for number, range_m in enumerate((3.8, 0.6, 2.9, 1.7, 0.9, 2.2)):
        seen.add(look(range_m, 0.72 * number))
    assert seen.obstacles(3.6) == []


def test_an_echo_lies_somewhere_on_the_arc_across_the_beam() -> None:
    seen = water()
    seen.add(look(4.0, 0.0))
    arc = seen.obstacles(0.0, SUSPECT)
    assert max(thing.east_m for thing in arc) - min(thing.east_m for thing in arc) > 0.5
    assert all(abs(math.atan2(thing.east_m, thing.north_m)) < WIDTH_RAD for thing in arc)


@pytest.mark.parametrize("range_m", [3.5, math.inf])
def test_what_is_closer_than_the_ranger_sees_stays(range_m: float) -> None:
    seen = water()
    for distance in (1.1, 0.5):
        for time_s in (0.0, 0.7):
            seen.add(look(distance, time_s))
    before = seen.evidence_at(Point(0.5, 0.01), 1.4)
    for time_s in (1.4, 2.1, 2.8):
        seen.add(Beam(time_s, HERE, 0.0, WIDTH_RAD, range_m, 4.0, 0.6))
    after = seen.evidence_at(Point(0.5, 0.01), 2.8)
    assert before is not None
    assert after is not None
    assert after > before - 0.2, "only faded"
    assert all(thing.north_m < 0.7 for thing in seen.obstacles(2.8, SUSPECT) if thing.north_m < 3.0)


def test_what_a_beam_reaches_beyond_is_gone() -> None:
    seen = water()
    for time_s in (0.0, 0.7):
        seen.add(look(2.0, time_s))
    assert seen.obstacles(0.7)
    for time_s in (1.4, 2.1):
        seen.add(look(3.5, time_s))
    assert all(thing.north_m > 3.0 for thing in seen.obstacles(2.1, SUSPECT))
    looks = seen.evidence_at(Point(2.0, 0.0), 2.1)
    assert looks is not None
    assert looks <= 0.0


def test_silence_takes_away_less_than_an_echo_from_beyond() -> None:
    silent, beyond = water(), water()
    for seen, range_m in ((silent, math.inf), (beyond, 3.5)):
        seen.add(look(2.0, 0.0))
        seen.add(look(2.0, 0.7))
        seen.add(look(range_m, 1.4))
    assert silent.obstacles(1.4, SOLID - 0.5)
    assert not any(thing.north_m < 3.0 for thing in beyond.obstacles(1.4, SOLID - 0.5))


def test_a_look_elsewhere_takes_nothing_away() -> None:
    seen = water()
    for time_s in (0.0, 0.7):
        seen.add(look(2.0, time_s))
    before = seen.obstacles(0.8)
    seen.add(look(math.inf, 0.8, bearing_rad=0.5))
    assert seen.obstacles(0.8) == before


def test_what_was_seen_often_is_remembered_longer_and_forgotten_in_the_end() -> None:
    twice, often = water(), water()
    for number in range(2):
        twice.add(look(2.0, 0.1 * number))
    for number in range(8):
        often.add(look(2.0, 0.1 * number))
    assert not twice.obstacles(15.0)
    assert often.obstacles(15.0)
    assert not often.obstacles(30.0)
    often.forget(HERE, 100.0, 60.0)
    assert len(often) == 0


def test_what_is_far_behind_is_dropped() -> None:
    seen = water()
    seen.add(look(2.0, 0.0))
    seen.forget(Point(50.0, 0.0), 18.0, 0.0)
    assert len(seen) == 0


def test_open_water_is_not_stored() -> None:
    seen = water()
    for number in range(100):
        seen.add(look(math.inf, 0.06 * number, bearing_rad=0.1 * number))
    assert len(seen) == 0


@given(
    st.lists(
        st.tuples(
            st.floats(-7.0, 7.0),
            st.one_of(st.just(math.inf), st.floats(0.02, 4.0)),
            st.floats(-100.0, 100.0),
            st.floats(0.01, 3.0),
        ),
        max_size=80,
    )
)
def test_memory_is_bounded_and_every_thing_was_within_reach(
    looks: list[tuple[float, float, float, float]],
) -> None:
    seen = Occupancy(0.05, 25.0)
    eyes = []
    for number, (bearing, range_m, north_m, width) in enumerate(looks):
        eyes.append(Point(north_m, 0.0))
        seen.add(Beam(0.06 * number, eyes[-1], bearing, width, range_m, 4.0))
    assert len(seen) <= MAX_CELLS
    for thing in seen.obstacles(5.0, SUSPECT):
        assert min(distance_m(eye, thing) for eye in eyes) < 4.0 + 0.1


@pytest.mark.parametrize("range_m", [0.02, 1.0, 3.99])
def test_an_arc_counts_once_for_each_of_its_cells(range_m: float) -> None:
    seen = water()
    seen.add(look(range_m, 0.0))
    assert all(seen.evidence_at(thing, 0.0) == 1.0 for thing in seen.obstacles(0.0, SUSPECT))


@pytest.mark.parametrize("origin", [Point(40.0, -60.0), Point(-128.0, 64.0)])
def test_the_map_knows_no_origin(origin: Point) -> None:
    here, there = water(), water()
    for number in range(200):
        bearing, range_m = 0.3 * number, (1.0 + 0.013 * number if number % 3 else math.inf)
        at = Point(0.01 * number + 0.003, -0.007 * number - 0.001)
        here.add(look(range_m, 100.0 + 0.1 * number, bearing, at))
        moved = Point(at.north_m + origin.north_m, at.east_m + origin.east_m)
        there.add(look(range_m, 100.0 + 0.1 * number, bearing, moved))
    for least in (SUSPECT, 1.0):
        one, other = here.obstacles(120.0, least), there.obstacles(120.0, least)
        assert len(one) == len(other) > 0
        back = [(at.north_m - origin.north_m, at.east_m - origin.east_m) for at in other]
        for a, b in zip(sorted(one), sorted(back), strict=True):
            assert b == pytest.approx(a, abs=0.02)


def test_a_cleared_map_is_empty() -> None:
    seen = water()
    seen.add(look(3.0, 0.0))
    seen.clear()
    assert len(seen) == 0


def test_what_was_just_seen_late_in_a_voyage_is_not_forgotten() -> None:
    seen = water()
    for time_s in (1000.0, 1000.7):
        seen.add(look(3.0, time_s))
    seen.forget(HERE, 10.0, 1001.0)
    assert seen.obstacles(1001.0)
