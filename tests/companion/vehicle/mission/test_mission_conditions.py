"""Commands that wait for a condition, and items that hold the boat up."""

import math

import pytest

from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.intent import HoldHeading, KeepStation
from companion.core.state import NavState
from companion.vehicle.mission import steps
from companion.vehicle.mission.conditions import ConditionalCommand
from companion.vehicle.mission.stationary_items import StationaryItem

HERE, END = Point(0.0, 0.0), Point(30.0, 0.0)


def nav_at(north_m: float = 0.0, heading: float = 0.0) -> NavState:
    return NavState(0.0, north_m, 0.0, heading, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1)


# Conditions


def test_a_delay_counts_from_when_it_was_asked_for() -> None:
    waiting = ConditionalCommand()
    waiting.wait_for(steps.AfterDelay(5.0), 100.0)
    assert not waiting.is_empty
    assert waiting.holds_back(steps.SetSpeed(1.0))
    assert waiting.holds_back(steps.Skip())
    assert waiting.take_due(HERE, END, 104.9) == []
    assert waiting.take_due(HERE, END, 105.0) == [steps.SetSpeed(1.0), steps.Skip()]
    assert waiting.is_empty


def test_a_second_delay_counts_from_the_end_of_the_first() -> None:
    waiting = ConditionalCommand()
    waiting.wait_for(steps.AfterDelay(5.0), 100.0)
    waiting.wait_for(steps.AfterDelay(3.0), 100.0)
    waiting.holds_back(steps.Skip())
    assert waiting.take_due(HERE, END, 106.0) == []
    assert waiting.take_due(HERE, END, 108.9) == []
    assert waiting.take_due(HERE, END, 109.0) == [steps.Skip()]


@pytest.mark.parametrize(("north_m", "is_due"), [(19.9, False), (20.1, True)])
def test_a_distance_is_to_the_end_of_the_leg(north_m: float, is_due: bool) -> None:
    waiting = ConditionalCommand()
    waiting.wait_for(steps.WithinDistance(10.0), 0.0)
    waiting.holds_back(steps.SetSpeed(1.0))
    assert (waiting.take_due(Point(north_m, 0.0), END, 1.0) == [steps.SetSpeed(1.0)]) is is_due


def test_at_the_end_of_the_leg_every_distance_is_kept() -> None:
    waiting = ConditionalCommand()
    waiting.wait_for(steps.WithinDistance(0.1), 0.0)
    waiting.holds_back(steps.SetSpeed(1.0))
    waiting.wait_for(steps.AfterDelay(2.0), 0.0)
    waiting.holds_back(steps.SetSpeed(2.0))
    assert waiting.take_due(HERE, None, 7.0) == [steps.SetSpeed(1.0)]
    assert waiting.take_due(HERE, END, 8.9) == []
    assert waiting.take_due(HERE, END, 9.0) == [steps.SetSpeed(2.0)]


# Items that hold the boat up


@pytest.mark.parametrize(("station", "place"), [(None, Point(4.0, 0.0)), (END, END)])
def test_a_wait_keeps_the_boat_where_it_lies(station: Point | None, place: Point) -> None:
    item = StationaryItem()
    assert item.begin(steps.Wait(5.0), nav_at(4.0), station, 100.0) == place
    assert item.intent(steps.Wait(5.0), nav_at(9.0), 104.9) == KeepStation(place)
    assert item.intent(steps.Wait(5.0), nav_at(9.0), 105.0) is None


@pytest.mark.parametrize(
    ("turn", "heading"),
    [
        (steps.Turn(1.0), 1.0),
        (steps.Turn(1.0, is_relative=True), 1.5),
        (steps.Turn(3.0, is_relative=True), 3.5),
    ],
)
def test_a_turn_is_to_a_heading_or_by_an_angle_to_starboard(turn: steps.Turn, heading: float) -> None:
    item = StationaryItem()
    assert item.begin(turn, nav_at(heading=0.5), END, 10.0) == END
    intent = item.intent(turn, nav_at(heading=0.5), 10.0)
    assert isinstance(intent, HoldHeading)
    assert intent.speed_m_s == 0.0
    assert math.remainder(intent.heading_rad - heading, math.tau) == pytest.approx(0.0, abs=1e-9)
    for off_deg, is_over in ((4.9, True), (-4.9, True), (5.1, False), (-5.1, False)):
        nav = nav_at(heading=heading + math.radians(off_deg))
        assert (item.intent(turn, nav, 10.1) is None) is is_over
    assert item.intent(turn, nav_at(heading=heading + 1.0), 39.9) is not None
    assert item.intent(turn, nav_at(heading=heading + 1.0), 40.0) is None


def test_a_hand_over_keeps_station_until_time_or_distance_are_used_up() -> None:
    item, step = StationaryItem(), steps.HandOver(is_on=True)
    item.limit = steps.LimitHandOver(20.0, 15.0)
    assert item.begin(step, nav_at(4.0), END, 100.0) == Point(4.0, 0.0)
    assert item.intent(step, nav_at(18.9), 119.9) == KeepStation(Point(4.0, 0.0))
    assert item.intent(step, nav_at(19.1), 119.9) is None
    assert item.intent(step, nav_at(18.9), 120.0) is None
    assert item.intent(steps.HandOver(is_on=False), nav_at(4.0), 100.0) is None


def test_a_limit_of_zero_is_none() -> None:
    item, step = StationaryItem(), steps.HandOver(is_on=True)
    assert item.limit == steps.LimitHandOver(0.0, 0.0)
    item.begin(step, nav_at(0.0), None, 0.0)
    assert item.intent(step, nav_at(1e6), 1e6) is not None


# Places


def test_a_place_is_on_the_globe_in_the_frame_or_from_where_the_leg_begins() -> None:
    frame, start = LocalFrame(LatLon(50.0, -1.2)), Point(7.0, -3.0)
    assert steps.locate(frame.to_global(Point(40.0, 30.0)), frame, start) == pytest.approx(
        (40.0, 30.0), abs=1e-3
    )
    assert steps.locate(Point(1.0, 2.0), frame, start) == Point(1.0, 2.0)
    assert steps.locate(steps.Offset(10.0, 20.0), frame, start) == Point(17.0, 17.0)
