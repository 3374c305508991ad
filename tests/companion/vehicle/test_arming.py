from functools import partial

import msgspec
import pytest
from boat_rig import GOOD_FIX, nav_at

from companion.config.boat_config import Arming, BoatConfig
from companion.core.modes import Mode
from companion.core.readings import BatteryReading, GnssFix
from companion.core.state import EstimateFault, NavState
from companion.vehicle.arming import PreArmReport, sensor_faults

FULL = BatteryReading(0.0, 12.4)


def faults(
    mode: Mode = Mode.GUIDED,
    nav: NavState | None = nav_at(),  # noqa: B008  a frozen value
    fix: GnssFix | None = GOOD_FIX,
    battery: BatteryReading | None = FULL,
    setting: Arming = Arming(),  # noqa: B008
    *,
    has_battery_monitor: bool = True,
) -> list[str]:
    config = BoatConfig(arming=setting)
    return sensor_faults(config, mode, nav, fix, battery, has_battery_monitor=has_battery_monitor)


@pytest.mark.parametrize(
    ("fix", "text"),
    [
        (None, "GPS: no 3-D fix"),
        (msgspec.structs.replace(GOOD_FIX, fix_type=2), "GPS: no 3-D fix"),
        (msgspec.structs.replace(GOOD_FIX, hdop=2.6), "GPS: HDOP 2.6 is above 2.5"),
    ],
)
def test_a_mode_that_steers_by_position_needs_a_good_fix(fix: GnssFix | None, text: str) -> None:
    assert faults(fix=fix) == [text]


def test_a_stale_position_and_a_silent_compass_are_told_apart() -> None:
    nav = nav_at(age_s=3.1)
    assert faults(nav=nav) == ["GPS: position is stale", "Compass: no heading"]
    assert faults(Mode.MANUAL, nav=None) == ["Compass: no heading"]
    assert faults(nav=nav_at(age_s=2.9)) == []


def test_a_heading_by_gyro_and_course_does_not_arm() -> None:
    nav = msgspec.structs.replace(nav_at(), faults=int(EstimateFault.COMPASS_LOST))
    assert faults(nav=nav) == ["Compass: no heading"]
    assert faults(nav=msgspec.structs.replace(nav, faults=int(EstimateFault.COMPASS_LATE))) == []


def test_an_empty_pack_and_a_silent_monitor_do_not_arm_and_a_missing_monitor_does() -> None:
    assert faults(battery=BatteryReading(0.0, 10.4)) == ["Battery: 10.4 V is below 10.5 V"]
    assert faults(battery=None) == ["Battery: unhealthy, the monitor is silent"]
    assert faults(battery=None, has_battery_monitor=False) == []


def told_at(since_s: float, ticks: int, repeat_s: float = 30.0) -> list[float]:
    """When the report says something, of a boat that does not arm from a moment on."""
    report = PreArmReport()
    times = [tick * 0.02 for tick in range(ticks)]

    def faults(now_s: float) -> list[str]:
        return ["Compass: no heading"] if now_s >= since_s else []

    return [now_s for now_s in times if report.update(partial(faults, now_s), now_s, repeat_s)]


def test_reasons_are_told_five_seconds_after_boot_and_then_every_thirty() -> None:
    assert told_at(0.0, 5000) == pytest.approx([5.0, 35.0, 65.0, 95.0], abs=0.03)


def test_a_reason_that_comes_up_later_is_told_within_a_second() -> None:
    assert told_at(12.3, 1000) == pytest.approx([12.8], abs=0.6)
