"""How far beyond the fence the boat is, and how often it has been."""

import pytest
from laid_fence import laid, square

from companion.config.tuning import MotorLimits
from companion.core.state import NavState
from companion.geofence.fence import FenceMonitor

SETTING = MotorLimits()
FENCE = laid(square(50.0))


def nav_at(north_m: float, age_s: float = 0.1) -> NavState:
    return NavState(0.0, north_m, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, age_s, 0.1)


def state(monitor: FenceMonitor) -> tuple[bool, bool, int, float]:
    return monitor.is_active, monitor.is_outside, monitor.breaches, monitor.breached_s


def test_every_way_out_counts_once_and_stamps_its_time() -> None:
    monitor = FenceMonitor()
    assert state(monitor) == (False, False, 0, 0.0)
    expected = [(49.9, False, 0, 0.0), (50.3, True, 1, 2.0), (53.0, True, 1, 2.0), (49.7, False, 1, 2.0)]
    for now_s, (north_m, is_outside, breaches, breached_s) in enumerate([*expected, (50.2, True, 2, 5.0)], 1):
        monitor.update(FENCE, nav_at(north_m), SETTING, float(now_s))
        assert state(monitor) == (True, is_outside, breaches, breached_s)
        assert monitor.beyond_m == pytest.approx(max(north_m - 50.0, 0.0), abs=1e-3)


def test_without_a_fresh_position_nothing_changes() -> None:
    monitor = FenceMonitor()
    monitor.update(FENCE, nav_at(53.0), SETTING, 1.0)
    for nav in (None, nav_at(0.0, age_s=3.1)):
        monitor.update(FENCE, nav, SETTING, 2.0)
        assert state(monitor) == (True, True, 1, 1.0)
    monitor.update(FENCE, nav_at(0.0, age_s=2.9), SETTING, 3.0)
    assert not monitor.is_outside


def test_without_a_fence_nobody_is_beyond_it() -> None:
    monitor = FenceMonitor()
    monitor.update(FENCE, nav_at(53.0), SETTING, 1.0)
    monitor.update(laid(), nav_at(53.0), SETTING, 2.0)
    assert state(monitor) == (False, False, 1, 1.0)
    assert monitor.beyond_m == 0.0
