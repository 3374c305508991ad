"""What a metre costs, against the wind triangle worked out by hand."""

import math

import numpy as np
import pytest
import shapely

from mission_tools.costs.current import UniformCurrent
from mission_tools.costs.travel import (
    BoatSpeed,
    Charge,
    Floats,
    InZones,
    OpenWater,
    SpeedZone,
    Travel,
    TravelTime,
)
from mission_tools.errors import UsageError

NORTH, EAST, SOUTH = 0.0, 0.5 * math.pi, math.pi


def per_m(travel: Travel, course_rad: float, north_m: float = 0.0, east_m: float = 0.0) -> float:
    place = np.array([north_m]), np.array([east_m])
    return float(travel.per_m(*place, np.array([course_rad]), np.zeros(1))[0])


@pytest.mark.parametrize(
    ("towards_deg", "current_m_s", "course_rad", "made_good_m_s"),
    [
        (0.0, 0.0, NORTH, 2.0),
        (180.0, 1.0, NORTH, 2.0),  # 3 m/s through the water reach
        (180.0, 1.5, NORTH, 1.5),
        (180.0, 2.95, NORTH, 0.0),  # 5 cm/s would be left
        (180.0, 2.85, NORTH, 0.15),
        (90.0, 1.8, NORTH, 2.0),  # √(3² − 1.8²) = 2.4 are left to go along
        (90.0, 2.4, NORTH, 1.8),
        (90.0, 3.1, NORTH, 0.0),
        (0.0, 2.5, NORTH, 2.8),  # it drifts faster than it cruises, and keeps steerage way
    ],
)
def test_the_speed_made_good(
    towards_deg: float, current_m_s: float, course_rad: float, made_good_m_s: float
) -> None:
    travel = TravelTime(BoatSpeed(2.0, 3.0), UniformCurrent.towards(current_m_s, towards_deg))
    expected = 1.0 / made_good_m_s if made_good_m_s else math.inf
    assert per_m(travel, course_rad) == pytest.approx(expected)


@pytest.mark.parametrize(("against_m_s", "can"), [(0.0, True), (0.05, True), (0.062, False)])
def test_a_boat_that_is_slower_than_the_least_speed_sails_as_well(against_m_s: float, *, can: bool) -> None:
    pool = TravelTime(BoatSpeed(0.045, 0.07, 0.02), UniformCurrent(-against_m_s, 0.0))
    assert math.isfinite(per_m(pool, NORTH)) is can


def test_the_charge_is_that_of_the_speed_through_the_water() -> None:
    def drawn_a(through_m_s: Floats) -> Floats:
        return 0.5 + through_m_s**3

    still = Charge(BoatSpeed(2.0, 3.0), drawn_a)
    assert per_m(still, EAST) == pytest.approx((0.5 + 8.0) / 2.0 / 3.6)
    against = Charge(BoatSpeed(1.0, 3.0), drawn_a, UniformCurrent(0.0, -1.0))
    assert per_m(against, EAST) == pytest.approx((0.5 + 8.0) / 1.0 / 3.6)
    across = Charge(BoatSpeed(1.0, 3.0), drawn_a, UniformCurrent(1.0, 0.0))
    assert per_m(across, EAST) == pytest.approx((0.5 + math.sqrt(2.0) ** 3) / 1.0 / 3.6)
    assert per_m(Charge(BoatSpeed(1.0, 1.0), drawn_a, UniformCurrent(0.0, -1.0)), EAST) == math.inf


def test_a_zone_slows_the_boat_within_it_and_the_lowest_limit_counts() -> None:
    zones = (SpeedZone(shapely.box(0, 0, 10, 10), 0.5), SpeedZone(shapely.box(5, 0, 20, 10), 1.0))
    travel = InZones(TravelTime(BoatSpeed(2.0, 3.0)), zones)
    assert [per_m(travel, NORTH, 5.0, east) for east in (-1.0, 2.0, 7.0, 15.0)] == pytest.approx(
        [0.5, 2.0, 2.0, 1.0]
    )
    assert travel.unit == "s"


def test_a_metre_near_the_shore_costs_more() -> None:
    travel = OpenWater(TravelTime(BoatSpeed(2.0, 3.0)), lambda north, east: east, weight=3.0, scale_m=5.0)
    assert [per_m(travel, NORTH, 0.0, east) for east in (0.0, 5.0, 500.0)] == pytest.approx(
        [2.0, 0.5 * (1.0 + 3.0 / math.e), 0.5]
    )
    assert travel.unit == "s"


@pytest.mark.parametrize(("over_ground", "top"), [(0.0, 1.0), (-1.0, 1.0), (2.0, 1.0), (1.0, math.inf)])
def test_a_speed_that_makes_no_sense_is_refused(over_ground: float, top: float) -> None:
    with pytest.raises(UsageError, match="expected more than 0"):
        BoatSpeed(over_ground, top)
