"""What a wind asks of a boat, against forces that are balanced anew, by symmetries, and by what boats do."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from companion.config.boat_config import BoatConfig, decode_config
from companion.core.geo import Point
from mission_tools.contract.budget import budget_of
from mission_tools.costs.boat import Boat, load_boat
from mission_tools.costs.current import UniformCurrent
from mission_tools.costs.travel import BoatSpeed, TravelTime
from mission_tools.costs.windage import InWind, in_wind
from mission_tools.errors import NoRoute, UsageError

WINDAGE = {
    "frontal_area_m2": 0.1,
    "lateral_area_m2": 0.3,
    "length_m": 1.0,
    "draught_m": 0.2,
    "pull_n": 10.0,
    "apart_m": 0.4,
}
RUDDER: dict[str, object] = {"windage": WINDAGE, "drive": {"layout": "rudder"}}
WINDS = st.floats(0.0, 6.0)
ANGLES = st.floats(-math.pi, math.pi)


def blowing(wind_m_s: float, from_rad: float, tree: dict[str, object] = RUDDER) -> InWind:
    calm = in_wind(decode_config(tree, "boat.toml"), 3.0, "0@0", "boat")
    return replace(calm, north_m_s=-wind_m_s * math.cos(from_rad), east_m_s=-wind_m_s * math.sin(from_rad))


def made_good(wind: InWind | None, course_rad: float = 0.0, along: float = 0.0, across: float = 0.0) -> float:
    speed = BoatSpeed(2.0, 3.0, 0.4, wind)
    return float(speed.made_good_m_s(np.array([along]), np.array([across]), np.array([course_rad]))[0])


def still(
    wind: InWind, good: float, course_rad: float = 0.0, along: float = 0.0, across: float = 0.0
) -> float:
    return float(wind.still_m_s(*(np.array([one]) for one in (good, along, across, course_rad)))[0])


def test_without_a_wind_a_load_is_that_of_the_speed_through_the_water() -> None:
    for good in (0.5, 1.7, 2.9):
        assert still(blowing(0.0, 0.0), good) == pytest.approx(good, rel=1e-3)
    low = {**RUDDER, "windage": {**WINDAGE, "frontal_area_m2": 1e-4, "lateral_area_m2": 1e-4}}
    for along, across in ((-1.5, 0.0), (0.5, 1.8), (2.5, 0.0), (-2.95, 0.0)):
        assert made_good(blowing(0.0, 0.0, low), 0.0, along, across) == pytest.approx(
            made_good(None, 0.0, along, across), rel=1e-3
        )


@pytest.mark.parametrize("wind_m_s", [4.0, 8.0, 11.0])
def test_into_the_wind_thrust_balances_the_drag_of_hull_and_air(wind_m_s: float) -> None:
    """The same balance, of one boat with a rudder, written down and solved again."""
    top_n, rest_n, air = 7.0, 10.0, 0.5 * 1.225 * 0.8 * 0.1 * 1.04

    def lacks_n(good: float, drive: float) -> float:
        thrust_n: float = rest_n * drive**2 - (rest_n - top_n) * drive * good / 3.0
        drag_n: float = top_n * (good / 3.0) ** 1.8 + air * ((wind_m_s + good) ** 2 - good**2)
        return drag_n - thrust_n

    fastest = brentq(lacks_n, 0.05, 3.0, args=(1.0,))
    wind = blowing(wind_m_s, 0.0)
    assert made_good(wind) == pytest.approx(min(fastest, 2.0), rel=0.01)
    drive = brentq(lambda share: lacks_n(1.0, share), 0.0, 2.0)
    same = brentq(lambda u: top_n * (u / 3.0) ** 1.8 - rest_n * drive**2 + 3.0 * drive * u / 3.0, 0.01, 6.0)
    assert still(wind, 1.0) == pytest.approx(same if drive <= 1.0 else 3.0 * drive, rel=0.01)


def test_the_current_counts_for_the_hull_and_the_speed_over_ground_for_the_air() -> None:
    against = still(blowing(4.0, 0.0), 1.0, along=-0.5)
    assert still(blowing(4.0, 0.0), 1.0) < against
    assert against < still(blowing(4.5, 0.0), 1.5)


def test_abeam_the_boat_makes_leeway_and_that_costs_more_than_the_air_ahead() -> None:
    deep = {**RUDDER, "windage": {**WINDAGE, "draught_m": 1.0}}
    abeam = 0.5 * math.pi
    shallow, ahead = still(blowing(5.0, abeam), 2.0), still(blowing(0.0, 0.0), 2.0)
    assert ahead < still(blowing(5.0, abeam, deep), 2.0) < shallow


@given(WINDS, ANGLES, ANGLES, ANGLES)
@settings(max_examples=60, deadline=None)
def test_whatever_way_the_whole_is_turned_or_mirrored_the_speed_is_the_same(
    wind_m_s: float, from_rad: float, course_rad: float, by_rad: float
) -> None:
    found = made_good(blowing(wind_m_s, from_rad), course_rad)
    assert made_good(blowing(wind_m_s, from_rad + by_rad), course_rad + by_rad) == pytest.approx(
        found, abs=1e-6
    )
    assert made_good(blowing(wind_m_s, -from_rad), -course_rad) == pytest.approx(found, abs=1e-6)


def test_more_wind_from_ahead_never_makes_a_boat_faster_or_draw_less() -> None:
    winds = [blowing(wind_m_s, 0.0) for wind_m_s in np.linspace(0.0, 14.0, 29)]
    assert (np.diff([made_good(wind) for wind in winds]) <= 1e-9).all()
    assert (np.diff([still(wind, 1.0) for wind in winds]) >= -1e-9).all()


def test_a_boat_that_its_gusts_would_turn_across_is_not_sailed_before_the_wind() -> None:
    pair: dict[str, object] = {"windage": WINDAGE}
    strong: dict[str, object] = {"windage": {**WINDAGE, "apart_m": 2.0}}
    assert made_good(blowing(8.0, math.pi, pair)) == 0.0
    assert made_good(blowing(8.0, math.pi, strong)) == pytest.approx(2.0)
    assert made_good(blowing(8.0, 0.0, pair)) > 0.5, "into the wind it holds its course"
    assert made_good(blowing(3.0, math.pi, pair)) == pytest.approx(2.0)
    assert made_good(blowing(12.0, math.pi)) == 0.0, "the rudder is too small as well"


def test_two_motors_that_steer_draw_more_than_a_rudder_that_does() -> None:
    abeam = 0.6 * math.pi
    pair: dict[str, object] = {"windage": WINDAGE}
    one, other = still(blowing(4.0, abeam, pair), 1.0), still(blowing(4.0, abeam), 1.0)
    assert one > other + 0.04


@pytest.mark.parametrize("text", ["6", "6@", "@90", "-6@90", "x@90", "6@east", "41@0", "6@90@10", ""])
def test_a_wind_that_is_none_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(UsageError, match=r"--wind '.*': expected M_S@FROM, such as 6@270"):
        in_wind(BoatConfig(), 3.0, text, "kit")


def test_a_wind_blows_from_where_it_says() -> None:
    wind = in_wind(decode_config(RUDDER, "boat.toml"), 3.0, " 6.5@270 ", "kit")
    assert (wind.north_m_s, wind.east_m_s) == pytest.approx((0.0, 6.5), abs=1e-9)
    assert wind.wind_m_s == pytest.approx(6.5)


@pytest.mark.parametrize("missing", ["frontal_area_m2", "lateral_area_m2", "pull_n"])
def test_a_boat_of_unknown_windage_is_told_what_to_measure(missing: str) -> None:
    config = decode_config({"windage": {**WINDAGE, missing: 0.0}}, "boat.toml")
    with pytest.raises(UsageError, match="boat does not say its windage: set frontal_area_m2"):
        in_wind(config, 3.0, "6@90", "boat")


def budget_s(boat: Boat, course_rad: float) -> float:
    out = Point(200.0 * math.cos(course_rad), 200.0 * math.sin(course_rad))
    return budget_of([Point(0.0, 0.0), out], [0.0], [0.0, 200.0], boat).time_s


def test_the_leg_that_cannot_be_sailed_is_told_with_the_reason() -> None:
    points = [Point(0.0, 0.0), Point(100.0, 0.0), Point(100.0, 100.0)]

    def refused(name: str, wind: str, current: UniformCurrent | None = None) -> str:
        with pytest.raises(NoRoute) as said:
            budget_of(points, [0.0, 0.0], [0.0] * 3, load_boat(name, wind), None, current or UniformCurrent())
        return str(said.value)

    across = "its gusts turn the boat across, harder than it can steer"
    assert refused("rudder", "8@270") == f"leg 2 cannot be sailed before 8 m/s of wind: {across}"
    assert refused("pool", "4@90").startswith("leg 1 cannot be sailed in 4 m/s of wind")
    assert refused("kit", "13@0") == "leg 1 cannot be sailed in 13 m/s of wind by a boat of 1.45 m/s"
    swept = refused("rudder", "8@0", UniformCurrent(-2.0, 0.0))
    assert swept == "leg 1 cannot be sailed in 8 m/s of wind and the current by a boat of 2.18 m/s"


def test_a_head_wind_costs_charge_and_at_full_throttle_time() -> None:
    kit, windy = load_boat("kit"), load_boat("kit", "4@0")
    assert budget_s(windy, 0.0) > 1.03 * budget_s(kit, 0.0)
    assert budget_s(windy, math.pi) == pytest.approx(budget_s(kit, math.pi))
    assert windy.held_a() > kit.held_a() + 0.02


def test_zones_and_costs_of_routes_know_the_wind() -> None:
    speed = load_boat("rudder", "5@0").speed()
    slow = speed.at_most(0.5)
    assert slow.wind is speed.wind
    ahead = TravelTime(load_boat("kit", "6@0").speed())
    north, south = (
        ahead.per_m(*(np.zeros(1),) * 2, np.array([way]), np.zeros(1))[0] for way in (0.0, math.pi)
    )
    assert north > 1.2 / 1.2
    assert math.isinf(south) or south < north
