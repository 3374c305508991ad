"""When a leg has ended, by hand-calculated places round its end."""

import pytest

from companion.core.geo import Point
from companion.core.intent import FollowLeg
from companion.core.state import NavState
from companion.guidance.leg import Leg

START, END = Point(0.0, 0.0), Point(100.0, 0.0)
EAST, BACK = Point(100.0, 100.0), Point(0.0, 0.0)


def nav_at(north_m: float, east_m: float) -> NavState:
    return NavState(0.0, north_m, east_m, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1)


@pytest.mark.parametrize(
    ("north_m", "east_m", "has_ended"),
    [
        (97.9, 0.0, False),
        (98.1, 0.0, True),
        (99.0, 1.8, False),  # 2.06 m away
        (100.1, 3.9, True),  # passed within twice the radius
        (100.1, -3.9, True),
        (99.9, 3.9, False),
        (100.1, 4.1, False),
        (103.0, 0.0, True),
    ],
)
def test_a_last_leg_ends_within_the_radius_or_abeam_within_twice_that(
    north_m: float, east_m: float, has_ended: bool
) -> None:
    assert Leg(START, END).has_ended(nav_at(north_m, east_m), 2.0) is has_ended


@pytest.mark.parametrize(("north_m", "has_ended"), [(94.0, False), (96.0, True)])
def test_a_radius_of_its_own_counts_before_the_configured_one(north_m: float, has_ended: bool) -> None:
    assert Leg(START, END, radius_m=5.0).has_ended(nav_at(north_m, 0.0), 2.0) is has_ended


@pytest.mark.parametrize(
    ("north_m", "east_m", "has_ended"),
    [
        (98.5, 0.0, False),  # within the radius, before the bisector
        (99.0, 1.1, True),  # beyond the bisector
        (99.0, 0.9, False),
        (97.5, 2.6, True),  # within twice the radius, beyond the bisector
        (96.0, 4.5, False),  # 6.02 m away: not there yet
    ],
)
def test_a_corner_ends_at_its_bisector(north_m: float, east_m: float, has_ended: bool) -> None:
    assert Leg(START, END, EAST).has_ended(nav_at(north_m, east_m), 2.0) is has_ended


@pytest.mark.parametrize(("north_m", "has_ended"), [(97.6, True), (97.4, False)])
def test_a_sharp_corner_may_be_passed_a_little_beyond_the_radius(north_m: float, has_ended: bool) -> None:
    astern = Point(13.4, 50.0)
    assert Leg(START, END, astern).has_ended(nav_at(north_m, 1.5), 2.0) is has_ended


def test_a_corner_ends_where_the_boat_leaves_it_after_it_was_near() -> None:
    leg = Leg(START, END, EAST)
    assert not leg.has_ended(nav_at(98.5, -1.0), 2.0)
    assert not leg.has_ended(nav_at(99.0, -2.2), 2.0), "2.42 m away"
    assert leg.has_ended(nav_at(99.0, -2.4), 2.0), "2.6 m away: beyond 1.25 radii"
    assert not Leg(START, END, EAST).has_ended(nav_at(99.0, -2.4), 2.0), "it was never near"


def test_a_boat_carried_far_past_the_end_begins_another_line_to_it() -> None:
    leg = Leg(START, END)
    assert not leg.has_ended(nav_at(102.0, 30.0), 2.0)
    assert leg.start == Point(102.0, 30.0)
    assert leg.intent(1.0) == FollowLeg(Point(102.0, 30.0), END, 1.0)
    assert leg.end == END


def test_a_boat_carried_off_abeam_of_the_end_begins_another_line_to_it() -> None:
    leg = Leg(START, END, EAST)
    assert not leg.has_ended(nav_at(97.0, -30.0), 2.0)
    assert leg.start == Point(97.0, -30.0)
    leg = Leg(START, END, EAST)
    assert not leg.has_ended(nav_at(95.0, -30.0), 2.0)
    assert leg.start == START, "farther ahead the line leads to the end"


def test_another_next_leg_counts_at_once() -> None:
    leg = Leg(START, END, EAST)
    leg.intent(1.0)
    leg.turn_onto(None)
    assert leg.intent(1.0).next_end is None
    assert leg.has_ended(nav_at(98.5, 0.0), 2.0), "a last leg ends within the radius"
    leg = Leg(START, END)
    leg.turn_onto(EAST)
    assert leg.intent(1.0).next_end == EAST
    assert not leg.has_ended(nav_at(98.5, 0.0), 2.0)
