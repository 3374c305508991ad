"""Turns with a bounded radius: they begin and end as asked, never turn tighter, and are the shortest."""

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from task_waters import basin, route_line

from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.units import wrap_pi
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.survey.survey import survey
from mission_tools.tasks.survey.turns import Pose, turn_length_m, turns, with_turns
from mission_tools.tasks.task_route import TaskLeg

RADIUS_M = 5.0
places = st.tuples(st.floats(-30.0, 30.0), st.floats(-30.0, 30.0))
courses = st.floats(-math.pi, math.pi)


def sailed(start: Pose, parts: tuple[tuple[int, float], ...]) -> Pose:
    """Where a boat ends that sails the parts, integrated in small steps."""
    north, east, course = start.place.north_m, start.place.east_m, start.course_rad
    for side, extent in parts:
        steps = 2000
        for _ in range(steps):
            step = extent / steps
            middle = course + 0.5 * side * step
            north += RADIUS_M * step * math.cos(middle)
            east += RADIUS_M * step * math.sin(middle)
            course += side * step
    return Pose(Point(north, east), course)


@given(places, courses, places, courses)
def test_every_path_ends_at_the_goal(
    start: tuple[float, float], course: float, goal: tuple[float, float], goal_course: float
) -> None:
    out, into = Pose(Point(*start), course), Pose(Point(*goal), goal_course)
    found = list(turns(out, into, RADIUS_M))
    assert len(found) >= 2
    lengths = [sum(part.extent for part in parts) for parts in found]
    assert lengths == sorted(lengths)
    # No path is shorter than the straight line, and the shortest longer by three circles at most.
    assert distance_m(out.place, into.place) <= RADIUS_M * lengths[0] + 1e-6
    assert RADIUS_M * lengths[0] <= distance_m(out.place, into.place) + 6.0 * math.pi * RADIUS_M
    ended = sailed(out, found[0])
    assert distance_m(ended.place, into.place) < 0.01
    assert abs(wrap_pi(ended.course_rad - into.course_rad)) < 1e-3


@pytest.mark.parametrize("across_m", [0.0, 3.0, 9.0, 10.0, 25.0])
def test_the_length_of_a_turn_into_the_neighbour_is_that_of_the_shortest_path(across_m: float) -> None:
    out, into = Pose(Point(0.0, 0.0), 0.0), Pose(Point(0.0, across_m), math.pi)
    shortest = sum(part.extent for part in next(turns(out, into, RADIUS_M)))
    estimated = float(turn_length_m(np.array(across_m), np.array(0.0), RADIUS_M))
    assert estimated == pytest.approx(RADIUS_M * shortest, rel=1e-9)


def test_a_boat_that_turns_on_the_spot_sails_the_straight_line() -> None:
    assert float(turn_length_m(np.array(3.0), np.array(4.0), 0.0)) == pytest.approx(5.0)


def track_pair(across_m: float) -> list[TaskLeg]:
    up, down = (
        (Point(20.0, 50.0), Point(70.0, 50.0)),
        (Point(70.0, 50.0 + across_m), Point(20.0, 50.0 + across_m)),
    )
    return [TaskLeg("track", up), TaskLeg("transit", (up[1], down[0])), TaskLeg("track", down)]


def sharpest_rad(points: tuple[Point, ...]) -> float:
    return max(
        abs(wrap_pi(bearing_rad(b, c) - bearing_rad(a, b)))
        for a, b, c in zip(points, points[1:], points[2:], strict=False)
    )


def test_a_narrow_turn_becomes_arcs_and_a_wide_one_stays() -> None:
    water = shapely.box(0.0, 0.0, 200.0, 100.0)
    narrow, tighter = with_turns(track_pair(6.0), water, RADIUS_M)
    assert tighter == 0
    assert sharpest_rad((Point(20.0, 50.0), *narrow[1].points, Point(20.0, 56.0))) < math.radians(25.0)
    for a, b in pairwise(narrow[1].points):
        assert distance_m(a, b) <= 2.0 * RADIUS_M * math.sin(math.radians(10.0)) + 1e-9
    wide, tighter = with_turns(track_pair(10.5), water, RADIUS_M)
    assert (wide, tighter) == (track_pair(10.5), 0)


def test_a_turn_for_which_there_is_no_room_is_counted() -> None:
    legs, tighter = with_turns(track_pair(6.0), shapely.box(0.0, 19.0, 200.0, 71.0), RADIUS_M)
    assert (legs, tighter) == (track_pair(6.0), 1)


def test_the_turns_of_a_survey_are_those_of_the_boat_and_stay_in_the_water() -> None:
    chart = basin(width_m=300.0, height_m=200.0)
    settings = SurveySettings(footprint_m=8.0, plan=PlanSettings(clearance_m=4.0), turn_radius_m=RADIUS_M)
    found = survey(chart, None, settings)
    assert found.route.notes == ()
    assert found.route.min_clearance_m(chart) >= 4.0
    tracks = [n for n, leg in enumerate(found.route.legs) if leg.kind == "track"]
    for first, second in pairwise(tracks):
        legs = found.route.legs[first : second + 1]
        if [leg.kind for leg in legs] != ["track", "transit", "track"]:
            continue
        across_m = abs(legs[0].points[-1].north_m - legs[2].points[0].north_m)
        length_m = float(turn_length_m(np.array(across_m), np.array(0.0), RADIUS_M))
        assert legs[1].length_m >= 0.97 * min(length_m, across_m if across_m >= 2.0 * RADIUS_M else math.inf)
    assert found.route.length_of_m("transit") < 0.5 * route_line(found.route.points).length
