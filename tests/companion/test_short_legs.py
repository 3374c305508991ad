"""Missions of many short legs: one line through several, every waypoint still passed in its turn."""

import math
from itertools import pairwise

import pytest
from boat_rig import FRAME, nav_at, place

from companion.config import BoatConfig
from companion.geo import Line, Point
from companion.guidance.onward import onward_speed_m_s
from companion.vehicle.intent import FollowLeg
from companion.vehicle.mission_progress import MissionProgress
from companion.vehicle.mission_steps import Home, Jump, Step, Waypoint

CONFIG = BoatConfig()


def mission(*places: tuple[float, float]) -> MissionProgress:
    return progress_of(*(Waypoint(place(*at)) for at in places))


def progress_of(*steps: Step) -> MissionProgress:
    progress = MissionProgress()
    progress.replace((Home(), *steps))
    return progress


def sailed(progress: MissionProgress, at: Point, step_m: float = 0.1, most: int = 20000) -> list[FollowLeg]:
    """The different legs that a boat is given which is exactly on its line, up to the end of the mission."""
    legs: list[FollowLeg] = []
    for _ in range(most):
        intent = progress.update(nav_at(*at), FRAME, CONFIG, 0.0)
        if progress.finished:
            return legs
        assert isinstance(intent, FollowLeg)
        if not legs or legs[-1] is not intent:
            legs.append(intent)
        line = intent.line
        along = line.along_and_cross_track_m(at)[0] + step_m
        at = Point(
            line.start.north_m + along * math.cos(line.course_rad),
            line.start.east_m + along * math.sin(line.course_rad),
        )
    raise AssertionError("the mission does not end")


def stairs(cells: int) -> list[tuple[float, float]]:
    """North and north-east in turn, from cell to cell of a grid of 1 m."""
    return [(float(n), float(n // 2)) for n in range(1, cells + 1)]


def test_stairs_are_sailed_as_one_leg_and_every_waypoint_is_reported() -> None:
    progress = mission(*stairs(30))
    legs = sailed(progress, Point(0.0, 0.0))
    courses = [leg.line.course_rad for leg in legs]
    assert max(courses) - min(courses) < math.radians(5.0)
    assert sorted(progress.take_reached()) == list(range(1, 31))


def test_a_long_mission_is_looked_through_piece_by_piece_without_a_bend_where_they_join() -> None:
    progress = mission(*stairs(200))
    legs = sailed(progress, Point(0.0, 0.0))
    courses = [leg.line.course_rad for leg in legs]
    assert max(courses) - min(courses) < math.radians(5.0)
    assert progress.take_reached() == list(range(1, 201))


def test_legs_of_a_mission_with_long_legs_are_sailed_as_they_are() -> None:
    places = [(50.0, 0.0), (50.0, 50.0), (0.0, 50.0)]
    legs = sailed(mission(*places), Point(0.0, 0.0))
    assert [tuple(leg.end) for leg in legs] == [pytest.approx(at, abs=1e-3) for at in places]
    assert all(leg.onward == () for leg in legs)


def test_a_leg_begins_where_the_one_before_it_was_told_to_lead() -> None:
    """So the arc between them is sailed to its end."""
    turns = [(float(n), 0.0) for n in range(1, 12)] + [(11.0, float(n)) for n in range(1, 12)]
    legs = sailed(mission(*turns, (11.0, 60.0), (80.0, 60.0)), Point(0.0, 0.0))
    for leg, onward in pairwise(legs):
        assert (leg.end, leg.next_end) == (onward.start, onward.end) or leg.line.course_rad == pytest.approx(
            onward.line.course_rad, abs=1e-3
        )


def test_a_first_waypoint_just_behind_the_boat_is_passed_without_turning_back() -> None:
    progress = mission((-1.0, 0.3), (20.0, 0.0))
    legs = sailed(progress, Point(0.0, 0.0))
    assert [leg.end.north_m for leg in legs] == [pytest.approx(20.0, abs=1e-3)] * len(legs)
    assert progress.take_reached() == [1, 2]


def test_a_boat_that_was_swept_away_from_a_short_leg_aims_at_its_waypoint_again() -> None:
    progress = mission(*stairs(30))
    progress.update(nav_at(0.0, 0.0), FRAME, CONFIG, 0.0)
    intent = progress.update(nav_at(9.0, -9.0), FRAME, CONFIG, 0.0)
    assert isinstance(intent, FollowLeg)
    assert intent.start == (9.0, -9.0)
    assert intent.end == pytest.approx((1.0, 0.0), abs=1e-3)


def test_a_ring_of_short_legs_is_sailed_round_and_round() -> None:
    ring = [(4.0 * math.sin(n * math.pi / 4), 4.0 * math.cos(n * math.pi / 4)) for n in range(8)]
    progress = progress_of(*(Waypoint(place(*at)) for at in ring), Jump(1, 2))
    legs = sailed(progress, Point(0.0, 4.0))
    assert progress.take_reached() == list(range(1, 9)) * 3
    assert len(legs) > 20


def test_a_corner_that_follows_closely_is_reckoned_with_at_the_one_before_it() -> None:
    line = Line(Point(0.0, 0.0), Point(3.0, 0.0))
    straight, sharp = Point(40.0, 0.0), Point(3.0, 30.0)
    assert onward_speed_m_s(line, (line.end, straight), 2.0, 2.0, CONFIG) == 2.0
    slow = onward_speed_m_s(line, (line.end, sharp), 2.0, 2.0, CONFIG)
    further = onward_speed_m_s(Line(Point(-4.0, 0.0), line.end), (line.end, sharp), 2.0, 2.0, CONFIG)
    assert CONFIG.guidance.min_speed_m_s <= slow < further < 2.0


def test_the_boat_is_able_to_stop_at_the_last_of_the_corners() -> None:
    line = Line(Point(0.0, 0.0), Point(2.0, 0.0))
    assert onward_speed_m_s(line, (line.end,), 2.0, 2.0, CONFIG) < 1.0
