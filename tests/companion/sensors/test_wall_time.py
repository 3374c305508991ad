"""The date: whose word counts."""

import pytest

from companion.core.geo import LatLon
from companion.core.readings import GnssFix
from companion.sensors.wall_time import WallTime

SATELLITES_S, STATION_S, COMPUTER_S = 1.8e9, 1.7e9, 1.6e9


def fix(time_s: float, unix_time_s: float | None) -> GnssFix:
    """A fix that came at a time since boot."""
    return GnssFix(time_s, LatLon(50.0, -1.2), 3, 12, 0.8, unix_time_s=unix_time_s)


def test_a_station_goes_before_the_computer_and_satellites_before_both() -> None:
    wall = WallTime(COMPUTER_S)
    wall.update(None, None)
    assert wall.unix_s(5.0) == COMPUTER_S + 5.0
    wall.update(fix(5.0, None), STATION_S)
    assert wall.unix_s(5.0) == STATION_S + 5.0
    wall.update(fix(6.0, SATELLITES_S), STATION_S)
    assert wall.unix_s(6.5) == pytest.approx(SATELLITES_S + 0.5)
    wall.update(fix(7.0, None), STATION_S)
    assert wall.unix_s(7.0) == pytest.approx(SATELLITES_S + 1.0)


@pytest.mark.parametrize("fix_type", [0, 1])
def test_the_date_of_a_receiver_without_a_fix_does_not_count(fix_type: int) -> None:
    wall = WallTime(COMPUTER_S)
    cold = GnssFix(5.0, LatLon(0.0, 0.0), fix_type, 0, 99.99, unix_time_s=315_964_800.0)
    wall.update(cold, None)
    assert wall.unix_s(5.0) == COMPUTER_S + 5.0
    wall.update(cold, STATION_S)
    assert wall.unix_s(5.0) == STATION_S + 5.0
    wall.update(fix(6.0, SATELLITES_S), STATION_S)
    assert wall.unix_s(6.0) == SATELLITES_S
