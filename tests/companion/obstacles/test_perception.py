"""Obstacle perception: pings from literal poses and times, the map, and the sector to look at."""

import math

import pytest
from boat_rig import nav_at
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from companion.config.tuning import AvoidanceSetting
from companion.core.geo import Point, distance_m
from companion.core.readings import SonarReading
from companion.core.state import NavState
from companion.obstacles.perception.occupancy import SUSPECT, Beam, Occupancy
from companion.obstacles.perception.perception import ObstaclePerception

SETTING = AvoidanceSetting()
NAV = nav_at(time_s=10.0)
NOW_S = 10.0


class Recorder(Occupancy):
    """A grid that keeps the beams that it is given. It is empty until a test says otherwise."""

    def __init__(self) -> None:
        super().__init__(0.2)
        self.beams: list[Beam] = []

    def add(self, beam: Beam) -> bool:
        self.beams.append(beam)
        return True


def perception() -> tuple[ObstaclePerception, list[Beam]]:
    found, recorder = ObstaclePerception(SETTING), Recorder()
    found.occupancy = recorder
    return found, recorder.beams


def beams_of(
    *pings: SonarReading, nav: NavState | None = NAV, width_rad: float | None = 0.3, now_s: float = NOW_S
) -> list[Beam]:
    seen, beams = perception()
    seen.ingest([(ping, width_rad) for ping in pings], nav, SETTING, now_s)
    assert seen.dropped == len(pings) - len(beams)
    return beams


@pytest.mark.parametrize("age_s", [0.0, 0.4, 0.95, -0.05])
def test_a_beam_starts_where_the_boat_was_and_pointed_at_the_time_of_the_ping(age_s: float) -> None:
    nav = replace(nav_at(50.0, -20.0), north_m_s=2.0, east_m_s=-1.0, heading_rad=0.3, yaw_rate_rad_s=0.5)
    (beam,) = beams_of(SonarReading(NOW_S - age_s, 0.7, 3.0), nav=nav)
    assert beam.at == pytest.approx((50.0 - 2.0 * age_s, -20.0 + age_s))
    assert beam.bearing_rad == pytest.approx(0.3 - 0.5 * age_s + 0.7)
    assert (beam.range_m, beam.reach_m, beam.width_rad) == (3.0, 4.0, 0.3)
    assert beam.time_s == NOW_S - age_s


def test_the_reach_is_the_rangers_up_to_the_lookahead_and_an_echo_is_no_nearer_than_it_can_measure() -> None:
    assert beams_of(SonarReading(NOW_S, 0.0, 3.0, 0.2, 9.0))[0].reach_m == SETTING.lookahead_m == 6.0
    assert beams_of(SonarReading(NOW_S, 0.0, 0.1, 0.2, 9.0))[0].range_m == 0.2
    assert beams_of(SonarReading(NOW_S, 0.0, 0.3, 0.2, 9.0))[0].range_m == 0.3
    assert beams_of(SonarReading(NOW_S, 0.0, 5.0, 0.2, 9.0))[0].blind_m == 0.2


@pytest.mark.parametrize(
    ("ping", "is_used"),
    [
        (SonarReading(9.01, 0.0, 3.0), True),
        (SonarReading(8.99, 0.0, 3.0), False),
        (SonarReading(10.09, 0.0, 3.0), True),
        (SonarReading(10.11, 0.0, 3.0), False),
        (SonarReading(10.0, 6.2, 3.0), True),
        (SonarReading(10.0, -6.2, 3.0), True),
        (SonarReading(10.0, 6.4, 3.0), False),
        (SonarReading(10.0, -6.4, 3.0), False),
        (SonarReading(10.0, 0.0, 0.001), True),
        (SonarReading(10.0, 0.0, 0.0), False),
        (SonarReading(10.0, 0.0, 3.0, 0.02, 0.5), True),
        (SonarReading(10.0, 0.0, 3.0, 0.02, 0.0), False),
        (SonarReading(10.0, 0.0, 3.0, 0.02, -4.0), False),
    ],
)
def test_a_ping_is_used_if_it_can_be(ping: SonarReading, is_used: bool) -> None:
    assert len(beams_of(ping)) == is_used


@pytest.mark.parametrize(
    ("position_age_s", "heading_age_s", "is_used"),
    [(1.9, 1.9, True), (2.1, 0.0, False), (0.0, 2.1, False)],
)
@pytest.mark.parametrize("range_m", [3.0, None])
def test_with_an_old_pose_nothing_is_located(
    position_age_s: float, heading_age_s: float, is_used: bool, range_m: float | None
) -> None:
    seen = ObstaclePerception(SETTING)
    nav = replace(NAV, position_age_s=position_age_s, heading_age_s=heading_age_s)
    seen.ingest([(SonarReading(NOW_S, 0.0, range_m), None)], nav, SETTING, NOW_S)
    assert seen.dropped == (0 if is_used else 1)
    assert (seen.reach_m, seen.heard_s) == ((4.0, NOW_S) if is_used else (0.0, -math.inf))


def silence(time_s: float = NOW_S, max_range_m: float = 4.0) -> SonarReading:
    return SonarReading(time_s, -0.25, None, 0.02, max_range_m)


@pytest.mark.parametrize(
    ("ping", "reach_m"),
    [
        (silence(max_range_m=9.0), 6.0),
        (silence(9.01), 4.0),
        (silence(8.99), 0.0),
        (silence(10.01), 4.0),
        (silence(max_range_m=0.5), 0.5),
        (silence(max_range_m=0.0), 0.0),
        (silence(max_range_m=math.nan), 0.0),
    ],
)
def test_silence_says_how_far_the_water_is_free(ping: SonarReading, reach_m: float) -> None:
    seen = ObstaclePerception(SETTING)
    seen.ingest([(ping, None)], NAV, SETTING, NOW_S)
    assert seen.reach_m == reach_m
    assert seen.dropped == (reach_m == 0.0)


def test_another_margin_begins_another_grid() -> None:
    seen = ObstaclePerception(SETTING)
    seen.ingest([(SonarReading(NOW_S, 0.0, 3.0), None)], NAV, SETTING, NOW_S)
    assert seen.occupancy.cell_m == pytest.approx(0.2)
    seen.ingest([], NAV, replace(SETTING, detour_m=5.0), NOW_S)
    assert len(seen.occupancy) > 0
    seen.ingest([], NAV, replace(SETTING, margin_m=2.0), NOW_S)
    assert len(seen.occupancy) == 0
    assert seen.occupancy.cell_m == pytest.approx(0.4)


def test_a_noisy_ranger_clears_the_map_once_and_its_pings_are_dropped() -> None:
    seen = ObstaclePerception(SETTING)
    number = 0
    while not seen.is_noisy and number < 200:
        range_m = 1.0 if number % 2 else 3.0
        seen.ingest([(SonarReading(NOW_S, 0.0, range_m), None)], NAV, SETTING, NOW_S)
        number += 1
    assert 20 < number < 60
    assert len(seen.occupancy) == 0
    assert seen.tracks.all == []
    assert seen.occupancy.cell_m == pytest.approx(0.2)
    assert seen.dropped == 1
    seen.ingest([(SonarReading(NOW_S, 0.0, 2.0), 0.3)], NAV, SETTING, NOW_S)
    assert len(seen.occupancy) > 0, "another ranger is believed"
    seen.ingest([(SonarReading(NOW_S, 0.0, 3.0), None)], NAV, SETTING, NOW_S)
    assert seen.dropped == 2
    assert len(seen.occupancy) > 0, "its echoes are kept"


def test_the_map_is_tidied_once_a_second_around_three_lookaheads() -> None:
    seen = ObstaclePerception(SETTING)
    seen.ingest([(SonarReading(NOW_S, 0.0, 3.0), None)], NAV, SETTING, NOW_S)
    far = nav_at(-15.5)  # 18.5 m away, of three times 6 m
    seen.ingest([], far, SETTING, NOW_S + 0.9)
    assert len(seen.occupancy) > 0
    seen.ingest([], nav_at(-14.5), SETTING, NOW_S + 1.1)
    assert len(seen.occupancy) > 0
    seen.ingest([], far, SETTING, NOW_S + 2.0)
    assert len(seen.occupancy) > 0
    seen.ingest([], far, SETTING, NOW_S + 2.2)
    assert len(seen.occupancy) == 0


def ping(time_s: float = 0.0, bearing_rad: float = 0.0, range_m: float | None = 3.0) -> SonarReading:
    return SonarReading(time_s, bearing_rad, range_m)


def seen_from(
    nav: NavState, *pings: SonarReading, now_s: float = 0.0, setting: AvoidanceSetting = SETTING
) -> ObstaclePerception:
    perception = ObstaclePerception(setting)
    perception.ingest([(one, None) for one in pings], nav, setting, now_s)
    return perception


def test_the_sight_is_that_of_the_longest_ranger_until_that_is_silent_for_a_sweep() -> None:
    perception = ObstaclePerception(SETTING)
    for time_s, reach_m, expected_m in ((9.0, 4.0, 4.0), (9.5, 2.0, 4.0), (10.2, 2.0, 2.0), (10.3, 4.0, 4.0)):
        one = SonarReading(time_s, 0.0, None, max_range_m=reach_m)
        perception.ingest([(one, None)], nav_at(), SETTING, time_s)
        assert perception.reach_m == expected_m


@pytest.mark.parametrize(("range_m", "counts"), [(3.0, True), (1.8, True), (1.4, False)])
def test_in_open_water_an_echo_counts_with_another_one_within_a_margin_and_a_half(
    range_m: float, *, counts: bool
) -> None:
    first = ping(0.0, 0.0, 3.0)
    assert seen_from(nav_at(), first).suspects() == []
    assert bool(seen_from(nav_at(), first, ping(0.06, 0.26, range_m)).suspects()) is counts


def test_beside_something_solid_a_single_echo_counts() -> None:
    rock = [ping(0.06 * number, 0.0, 3.0) for number in range(2)]
    seen = seen_from(nav_at(), *rock, ping(0.12, 1.3, 2.0), now_s=0.18)
    assert seen.solid()
    assert min(distance_m(thing, Point(0.53, 1.93)) for thing in seen.suspects()) < 0.2


def swept(seen: ObstaclePerception, begin_s: float, range_m: float) -> None:
    """Something ahead, with free water on either side."""
    for number, bearing_rad in enumerate((-0.26, 0.0, 0.26)):
        time_s = begin_s + 0.06 * number
        echo_m = None if bearing_rad else range_m
        seen.ingest([(SonarReading(time_s, bearing_rad, echo_m), None)], nav_at(), SETTING, time_s)


def test_what_stands_among_still_things_is_no_possible_mover() -> None:
    rock = ObstaclePerception(SETTING)
    for begin_s in (0.0, 0.5, 1.0):
        swept(rock, begin_s, 3.0)
    tracks, still_count = rock.possible_movers(1.2)
    assert (len(tracks), still_count) == (1, 0), "it was met just now"
    for begin_s in (1.5, 2.0, 2.5, 3.0, 3.5, 4.0):
        swept(rock, begin_s, 3.0)
    tracks, still_count = rock.possible_movers(4.2)
    assert tracks == []
    coming = ObstaclePerception(SETTING)
    for number in range(9):
        swept(coming, 0.5 * number, 3.8 - 0.25 * number)
    assert len(coming.possible_movers(4.2)[0]) == 1


def test_what_is_known_to_move_leaves_nothing_in_the_grid_nor_in_the_map_of_the_voyage() -> None:
    seen = ObstaclePerception(SETTING)
    for number in range(9):
        swept(seen, 0.5 * number, 3.8 - 0.25 * number)
    (mover,) = seen.tracks.movers(4.2)
    assert mover.created_s == pytest.approx(0.06)
    assert seen.solid() == []
    assert not seen.voyage.is_near(Point(3.0, 0.0), 1.5)


def test_where_something_stands_what_moves_takes_nothing_out_of_the_map() -> None:
    seen = ObstaclePerception(SETTING)
    seen.occupancy.restore(Point(0.0, 3.0), 0.0)
    for number in range(9):
        swept(seen, 4.0 + 0.5 * number, 3.8 - 0.25 * number)
    assert seen.tracks.movers(8.2)
    assert min(distance_m(cell, Point(2.8, 0.0)) for cell in seen.solid()) < 0.4


def test_still_things_are_counted_by_margins() -> None:
    seen = seen_from(nav_at(), ping(0.0, 0.0, 3.0))
    for place in (Point(2.1, 0.1), Point(2.3, 0.1), Point(3.1, 5.1)):
        seen.occupancy.restore(place, 0.0)
    seen.ingest([(ping(0.06, 0.3, None), None)], nav_at(), SETTING, 0.06)
    assert seen.possible_movers(0.1)[1] == 2


@given(
    st.lists(
        st.builds(
            SonarReading,
            time_s=st.floats(),
            bearing_rad=st.floats(),
            range_m=st.none() | st.floats(),
            min_range_m=st.floats(),
            max_range_m=st.floats(),
        ),
        max_size=20,
    ),
    st.none() | st.floats(),
)
def test_any_reading_of_a_ranger_leaves_the_map_valid(
    pings: list[SonarReading], width_rad: float | None
) -> None:
    perception = ObstaclePerception(SETTING)
    perception.ingest([(one, width_rad) for one in pings], nav_at(), SETTING, 0.0)
    for thing in perception.occupancy.obstacles(SUSPECT):
        assert distance_m(Point(0.0, 0.0), thing) <= SETTING.lookahead_m + 1.0


def at_speed() -> NavState:
    return replace(nav_at(), north_m_s=2.0, surge_m_s=2.0)


def sector_after(*pings: SonarReading, now_s: float) -> tuple[float, float]:
    perception = ObstaclePerception(SETTING)
    for one in pings:
        perception.ingest([(one, None)], nav_at(), SETTING, one.time_s)
    astern = ping(now_s, 3.0, None)
    perception.ingest([(astern, 0.3)], at_speed(), SETTING, now_s)
    return perception.sector


def test_the_ranger_turns_back_to_a_single_echo() -> None:
    assert sector_after(ping(0.0, 0.5), now_s=0.06) == pytest.approx((0.5, 0.5))
    assert sector_after(ping(0.0, 0.5), ping(0.06, 0.8, None), now_s=0.08) == pytest.approx((0.5, 0.5))


@pytest.mark.parametrize("second", [ping(0.12, 0.5), ping(0.12, 0.5, None)])
def test_a_second_look_confirms_or_refutes_an_echo(second: SonarReading) -> None:
    port_rad, starboard_rad = sector_after(ping(0.0, 0.5), second, now_s=0.14)
    assert starboard_rad - port_rad > 0.5


def test_an_echo_that_cannot_be_looked_at_again_is_given_up() -> None:
    assert sector_after(ping(0.0, 0.5), now_s=0.29) == pytest.approx((0.5, 0.5))
    port_rad, starboard_rad = sector_after(ping(0.0, 0.5), now_s=0.31)
    assert starboard_rad - port_rad > 0.5


def test_spray_is_neither_tracked_nor_looked_at_again_nor_free_water() -> None:
    seen = ObstaclePerception(SETTING)
    seen.water.is_used = True
    fast = replace(NAV, north_m_s=2.0)
    seen.ingest([(SonarReading(NOW_S, 0.0, 0.5), None)], fast, SETTING, NOW_S)
    assert seen.tracks.known(NOW_S) == seen.tracks.all == []
    assert seen.sector.port_rad < seen.sector.starboard_rad  # not pinned to the echo
    assert not seen.water.is_known(Point(NAV.north_m + 0.2, NAV.east_m))


def test_where_something_barred_a_planned_way_the_chart_is_distrusted_until_the_map_is_cleared() -> None:
    seen = ObstaclePerception(SETTING)
    for barred in (True, False):
        seen.voyage.clear()
        seen.voyage.has_barred_a_way = barred
        seen.ingest([], NAV, SETTING, NOW_S)
        assert seen.water.distrusts_chart is barred
