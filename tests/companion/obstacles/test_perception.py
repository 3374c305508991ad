import msgspec
import pytest
from boat_rig import nav_at
from hypothesis import given
from hypothesis import strategies as st

from companion.config.tuning import AvoidanceSetting
from companion.core.geo import Point, distance_m
from companion.core.readings import SonarReading
from companion.core.state import NavState
from companion.obstacles.perception.occupancy import SUSPECT
from companion.obstacles.perception.perception import ObstaclePerception

SETTING = AvoidanceSetting()


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
    assert seen_from(nav_at(), first).suspects(0.0) == []
    assert bool(seen_from(nav_at(), first, ping(0.06, 0.26, range_m)).suspects(0.06)) is counts


def test_beside_something_solid_a_single_echo_counts() -> None:
    rock = [ping(0.06 * number, 0.0, 3.0) for number in range(2)]
    seen = seen_from(nav_at(), *rock, ping(0.12, 1.3, 2.0), now_s=0.18)
    assert seen.solid(0.18)
    assert min(distance_m(thing, Point(0.53, 1.93)) for thing in seen.suspects(0.18)) < 0.2


def test_a_boat_that_does_not_know_where_it_is_puts_nothing_on_the_map() -> None:
    assert seen_from(nav_at(age_s=10.0), ping()).is_empty
    lost = ObstaclePerception(SETTING)
    lost.ingest([(ping(), None)], None, SETTING, 0.0)
    assert lost.is_empty
    assert lost.dropped == 1


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
    for thing in perception.occupancy.obstacles(0.0, SUSPECT):
        assert distance_m(Point(0.0, 0.0), thing) <= SETTING.lookahead_m + 1.0


def at_speed() -> NavState:
    return msgspec.structs.replace(nav_at(), north_m_s=2.0, surge_m_s=2.0)


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


def test_obstacles_of_others_do_not_turn_the_ranger() -> None:
    perception = ObstaclePerception(SETTING)
    perception.ingest([(ping(0.0, 0.5), 0.3)], at_speed(), SETTING, 0.02)
    assert perception.sector[1] - perception.sector[0] > 0.5


def test_among_things_that_lie_still_the_whole_sweep_is_kept_after_an_echo() -> None:
    rock = [ping(0.0, -1.2, 2.0), ping(0.06, -1.2, 2.0)]
    port_rad, starboard_rad = sector_after(*rock, ping(0.12, 0.5), now_s=0.14)
    assert starboard_rad - port_rad > 0.5
