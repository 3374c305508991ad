"""The charge that is left against the charge for the way home, worked out by hand."""

import math

import pytest
from boat_rig import nav_at
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, with_value
from companion.core.geo import Point
from companion.core.readings import BatteryReading
from companion.core.state import NavState
from companion.failsafe.endurance import Endurance

CONFIG = with_value(BoatConfig(), "battery.capacity_mah", 5000.0)
HOME = Point(0.0, 0.0)


def sailing(
    speed_m_s: float = 1.0, current_m_s: tuple[float, float] = (0.0, 0.0), at_m: float = 720.0
) -> NavState:
    """North of home, at this speed through the water, in this current north and east."""
    north, east = current_m_s
    return replace(
        nav_at(at_m),
        north_m_s=speed_m_s + north,
        east_m_s=east,
        current_north_m_s=north,
        current_east_m_s=east,
    )


def after(seconds: float, nav: NavState, draw_a: float = 5.0) -> Endurance:
    """A pack that began full and has delivered this draw for so long."""
    endurance = Endurance()
    endurance.renew(1.0)
    for _ in range(round(seconds * 10)):
        endurance.learn(BatteryReading(0.0, 12.0, draw_a), nav, CONFIG, 0.1)
    return endurance


def range_fault(endurance: Endurance, nav: NavState, consumed_mah: float, way_m: float = math.inf) -> str:
    endurance.compare(nav, HOME, way_m, BatteryReading(0.0, 12.0, 5.0), consumed_mah, CONFIG, 0.0)
    return endurance.range_fault


@pytest.mark.parametrize(
    ("current_m_s", "made_good_m_s"),
    [
        ((-0.5, 0.0), 1.5),  # home is south
        ((0.5, 0.0), 0.5),
        ((0.0, 0.6), 0.8),  # across: the rest of the triangle
        ((0.95, 0.0), 0.1),  # never slower than a tenth of the speed through the water
        ((2.0, 0.0), 0.1),
    ],
)
def test_the_current_counts_along_the_way_and_across(
    current_m_s: tuple[float, float], made_good_m_s: float
) -> None:
    nav = sailing(current_m_s=current_m_s)
    assert after(30.0, nav).way_home_mah(nav, HOME) == pytest.approx(1000.0 / made_good_m_s)


def test_the_boat_turns_for_home_at_one_and_a_half_times_the_charge_for_it() -> None:
    # Of 5000 mAh a tenth is the reserve: 4500 mAh; the way home takes 1000 mAh, 1500 mAh with its margin
    endurance = after(30.0, sailing())
    assert range_fault(endurance, sailing(), 2990.0) == ""
    assert range_fault(endurance, sailing(), 3010.0) == "Point of no return: 1490 mAh, 1500 needed"
    assert range_fault(endurance, sailing(), 2990.0) == ""


@pytest.mark.parametrize(
    ("seconds", "nav", "is_known"),
    [
        (19.8, sailing(), False),
        (20.2, sailing(), True),
        (60.0, sailing(0.29), False),
        (60.0, sailing(0.31), True),
        (60.0, sailing(at_m=9.9), False),
        (60.0, sailing(at_m=10.1), True),
    ],
)
def test_a_boat_that_has_hardly_sailed_or_is_home_knows_nothing(
    seconds: float, nav: NavState, is_known: bool
) -> None:
    assert math.isnan(after(seconds, nav).way_home_mah(nav, HOME)) is not is_known


def test_draw_and_speed_are_those_of_the_last_half_minute() -> None:
    endurance = after(300.0, sailing())
    for _ in range(300):
        endurance.learn(BatteryReading(0.0, 12.0, 10.0), sailing(2.0), CONFIG, 0.1)
    assert endurance.draw_a == pytest.approx(10.0 - 5.0 / math.e, abs=0.02)
    assert endurance.water_speed_m_s == pytest.approx(2.0 - 1.0 / math.e, abs=0.01)


def test_without_a_current_monitor_a_home_or_a_position_nothing_is_said() -> None:
    endurance = after(30.0, sailing())
    battery = BatteryReading(0.0, 12.0, 5.0)
    for nav, home, reading in (
        (None, HOME, battery),
        (sailing(), None, battery),
        (sailing(), HOME, None),
        (sailing(), HOME, BatteryReading(0.0, 12.0)),
    ):
        endurance.compare(nav, home, math.inf, reading, 5000.0, CONFIG, 0.0)
        assert endurance.range_fault == ""


def test_a_new_pack_ends_the_shortfall_and_the_comparison_is_due_once_a_second() -> None:
    endurance = after(30.0, sailing())
    assert range_fault(endurance, sailing(), 4000.0)
    endurance.renew(1.0)
    assert endurance.range_fault == ""
    assert endurance.is_due(1.0)
    assert endurance.is_due(1.0), "asking changes nothing"
    endurance.compare(sailing(), HOME, math.inf, None, 0.0, CONFIG, 1.0)
    assert not endurance.is_due(1.9)
    assert endurance.is_due(2.0)


def test_the_charge_at_boot_is_read_from_the_resting_voltage() -> None:
    endurance = Endurance()
    endurance.learn(BatteryReading(0.0, 4.2 * CONFIG.battery.cells, 0.0), None, CONFIG, 0.1)
    full = endurance.left_mah(0.0, CONFIG)
    assert full == pytest.approx(0.9 * 5000.0, rel=0.01)
    endurance.learn(BatteryReading(0.0, 3.0 * CONFIG.battery.cells, 0.0), None, CONFIG, 0.1)
    assert endurance.left_mah(0.0, CONFIG) == full, "only once"
