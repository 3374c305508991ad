"""Where a boat drifts that the current carries faster than it sails."""

import math

import pytest

from companion.core.geo import Point
from companion.core.state import Demand, NavState
from companion.guidance.drift_heading import DriftHeading, drift_demand

WANTED = Demand(1.0, 0.5)


def nav_at(current_m_s: tuple[float, float] = (0.0, 0.0), north_m: float = 0.0) -> NavState:
    return NavState(
        0.0, north_m, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1,
        current_north_m_s=current_m_s[0], current_east_m_s=current_m_s[1],
    )  # fmt: skip


class Wall:
    """A line across the way north, open to the east of it."""

    is_active = True

    def is_near(self, point: Point, reach_m: float) -> bool:
        return 40.0 - point.north_m < reach_m

    def room_m(self, point: Point, course_rad: float, reach_m: float) -> float:
        north, east = math.cos(course_rad), math.sin(course_rad)
        if north <= 0.0:
            return reach_m
        way_m = (40.0 - point.north_m) / north
        return reach_m if point.east_m + way_m * east > 15.0 else min(way_m, reach_m)


def test_with_room_all_round_it_points_into_the_current() -> None:
    demand = drift_demand(nav_at(current_m_s=(0.0, -0.8)), Wall(), 0.35)
    assert demand.heading_rad == pytest.approx(math.pi / 2.0)


def test_a_boat_that_holds_its_own_far_from_lines_keeps_what_is_wanted() -> None:
    assert DriftHeading().update(WANTED, nav_at((0.0, 0.34)), Wall(), 0.35, 0.0) is WANTED


def test_in_a_current_faster_than_the_boat_the_drift_is_chosen() -> None:
    nav = nav_at((0.0, 0.36))
    assert DriftHeading().update(WANTED, nav, Wall(), 0.35, 0.0) == drift_demand(nav, Wall(), 0.35)


@pytest.mark.parametrize(("north_m", "is_free"), [(31.9, True), (32.1, False)])
def test_within_eight_metres_of_a_line_the_drift_is_chosen(north_m: float, is_free: bool) -> None:
    demand = DriftHeading().update(WANTED, nav_at(north_m=north_m), Wall(), 0.35, 0.0)
    assert (demand is WANTED) is is_free


def test_a_chosen_drift_is_kept_for_two_seconds() -> None:
    drift, east, west = DriftHeading(), nav_at((0.0, 0.8)), nav_at((0.0, -0.8))
    first = drift.update(WANTED, east, Wall(), 0.35, 10.0)
    assert drift.update(WANTED, west, Wall(), 0.35, 11.9) is first
    assert drift.update(WANTED, west, Wall(), 0.35, 12.0) == drift_demand(west, Wall(), 0.35)


def test_a_drift_is_chosen_anew_after_the_boat_was_free() -> None:
    drift, west = DriftHeading(), nav_at((0.0, -0.8))
    drift.update(WANTED, nav_at((0.0, 0.8)), Wall(), 0.35, 10.0)
    assert drift.update(WANTED, nav_at(), Wall(), 0.35, 10.1) is WANTED
    assert drift.update(WANTED, west, Wall(), 0.35, 10.2) == drift_demand(west, Wall(), 0.35)
