"""What the station makes of what a boat says of heading and battery."""

import pytest
from blank_messages import blank

from companion.mavlink.dialect import dialect
from mission_tools.station.messages import Battery
from mission_tools.station.view import HANDLERS, View
from mission_tools.station.words import say


@pytest.mark.parametrize(
    ("has_heading", "share", "ok", "word"),
    [
        (False, None, False, "compass.none"),
        (False, 0.1, False, "compass.none"),
        (True, 1.0, False, "compass.none"),
        (True, 0.8, False, "compass.substitute"),
        (True, 0.79, True, "compass.good"),
        (True, None, True, "compass.good"),
    ],
)
def test_a_heading_is_good_while_the_boat_has_one_and_its_filter_trusts_the_compass(
    has_heading: bool, share: float | None, ok: bool, word: str
) -> None:
    seen = View()
    assert seen.compass() is None
    seen.has_heading, seen.heading_share = has_heading, share
    verdict = seen.compass()
    assert verdict is not None
    assert (verdict.ok, verdict.text) == (ok, say(word))


def told_by(**values: int) -> Battery | None:
    """The battery after a SYS_STATUS with these fields."""
    view = View()
    HANDLERS[dialect.MAVLINK_MSG_ID_SYS_STATUS](view, blank("sys_status", **values))
    return view.battery


def test_a_percentage_is_0_to_100_and_a_current_not_negative() -> None:
    for told, percent in ((-1, None), (0, 0), (100, 100), (101, None)):
        battery = told_by(battery_remaining=told, current_battery=-1, voltage_battery=0xFFFF)
        assert battery is not None
        assert (battery.percent, battery.current_a, battery.voltage_v) == (percent, None, None)
    measured = told_by(current_battery=0, voltage_battery=11_400)
    assert measured is not None
    assert (measured.current_a, measured.voltage_v) == (0.0, 11.4)
