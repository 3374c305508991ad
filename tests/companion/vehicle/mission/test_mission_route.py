"""The way that a mission leads: its corners, and every waypoint still passed in its turn."""

import math

import pytest
from boat_rig import FRAME, nav_at, place

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import FollowLeg
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.mission.route import MissionRoute, waypoints_ahead
from companion.vehicle.mission.steps import (
    GoRound,
    HandOver,
    Home,
    Jump,
    ReturnHome,
    SetSpeed,
    Step,
    Turn,
    Wait,
    Waypoint,
)

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


# Which waypoints follow


def test_it_looks_through_one_jump_as_often_as_that_is_still_made() -> None:
    a, b, c = (Waypoint(place(n, 0.0)) for n in (1.0, 2.0, 3.0))
    steps = (Home(), a, b, Jump(1, 2), c)
    assert waypoints_ahead(steps, 2, {3: 2}) == ([c], False)
    assert waypoints_ahead(steps, 2, {3: 1}) == ([a, b], True)


# What is sailed


def test_a_long_mission_is_looked_through_piece_by_piece_without_a_bend_where_they_join() -> None:
    progress = mission(*stairs(200))
    legs = sailed(progress, Point(0.0, 0.0))
    courses = [leg.line.course_rad for leg in legs]
    assert max(courses) - min(courses) < math.radians(5.0)
    assert progress.take_reached() == list(range(1, 201))


def test_a_boat_that_was_swept_away_from_a_short_leg_aims_at_its_waypoint_again() -> None:
    progress = mission(*stairs(30))
    progress.update(nav_at(0.0, 0.0), FRAME, CONFIG, 0.0)
    intent = progress.update(nav_at(9.0, -9.0), FRAME, CONFIG, 0.0)
    assert isinstance(intent, FollowLeg)
    assert intent.start == (9.0, -9.0)
    assert intent.end == pytest.approx((1.0, 0.0), abs=1e-3)


@pytest.mark.parametrize(("nearest_east_m", "seq"), [(0.4, 5), (-0.6, 3)])
def test_close_waypoints_before_a_corner_count_once_the_boat_was_near_each(
    nearest_east_m: float, seq: int
) -> None:
    """The fillet cuts the corner behind them, so the boat leaves them before their legs begin."""
    progress = mission((20.0, 0.0), (20.0, 0.7), (20.0, 1.4), (20.0, 2.1), (0.0, 0.0))
    for at in ((18.0, -8.0), (19.0, -1.5), (19.2, nearest_east_m), (17.2, nearest_east_m), (16.8, 0.2)):
        progress.update(nav_at(*at), FRAME, CONFIG, 0.0)
    assert progress.current_seq == seq


def test_a_boat_that_passes_the_end_of_a_short_last_leg_turns_back_to_it() -> None:
    """The last leg leads back, so on the line straight to its end the boat can pass that unnoticed."""
    progress = mission((20.0, 0.0), (40.0, 0.0), (39.0, 1.0))
    for along in range(40):
        progress.update(nav_at(float(along), 0.0), FRAME, CONFIG, 0.0)
    progress.update(nav_at(39.5, -2.5), FRAME, CONFIG, 0.0)
    progress.update(nav_at(41.0, -2.5), FRAME, CONFIG, 0.0)
    assert progress.current_seq == 3
    for north, east in ((43.0, -2.5), (45.0, -2.5), (60.0, -2.5)):
        intent = progress.update(nav_at(north, east), FRAME, CONFIG, 0.0)
        assert isinstance(intent, FollowLeg)
        assert intent.end == pytest.approx((39.0, 1.0), abs=1e-3)
        along_m, _ = intent.line.along_and_cross_track_m(Point(north, east))
        assert along_m < intent.line.length_m


def test_what_follows_a_leg_is_looked_for_once_and_again_when_it_may_have_changed() -> None:
    route, first = MissionRoute(), Waypoint(place(20.0, 0.0))
    onward = [(Home(), first, Waypoint(place(20.0, east_m))) for east_m in (30.0, 40.0)]
    leg = route.lay(first, Point(0.0, 0.0), FRAME)
    assert route.lay(first, Point(5.0, 5.0), FRAME) is leg
    route.look_ahead(onward[0], 1, {}, FRAME, 2.0)
    assert leg.next_end == pytest.approx((20.0, 30.0), abs=1e-3)
    route.look_ahead(onward[1], 1, {}, FRAME, 2.0)
    assert leg.next_end == pytest.approx((20.0, 30.0), abs=1e-3)
    route.forget_onward()
    route.look_ahead(onward[1], 1, {}, FRAME, 2.0)
    assert leg.next_end == pytest.approx((20.0, 40.0), abs=1e-3)
    route.pass_waypoint()
    assert route.leg is None
    assert route.lay(first, Point(5.0, 5.0), FRAME).start == (5.0, 5.0)


@pytest.mark.parametrize(
    "after", [Wait(1.0), Turn(1.0), HandOver(is_on=True), ReturnHome(), GoRound(Point(0.0, 0.0), 1.0)]
)
def test_no_waypoint_behind_a_stop_follows(after: Step) -> None:
    a, b = Waypoint(place(1.0, 0.0)), Waypoint(place(2.0, 0.0))
    assert waypoints_ahead((Home(), a, b, after, a), 1, {}) == ([b], False)
    assert waypoints_ahead((Home(), a, SetSpeed(1.0), b), 1, {}) == ([b], False)
    assert waypoints_ahead((Home(), a, Jump(4, -1), b, a, after), 1, {2: 99}) == ([a], False)


def test_a_loop_without_waypoints_is_not_looked_through_for_ever() -> None:
    a = Waypoint(place(1.0, 0.0))
    assert waypoints_ahead((Home(), a, SetSpeed(1.0), Jump(2, -1), a), 1, {}) == ([], True)
    assert waypoints_ahead((Home(), a, *[SetSpeed(1.0)] * 200, a), 1, {}) == ([], True)
    assert waypoints_ahead((Home(), a, *[SetSpeed(1.0)] * 98, a), 1, {}) == ([a], False)


def test_guidance_is_told_of_sixteen_corners_beyond_the_next_leg() -> None:
    progress = mission(*((50.0 * n, 40.0 * (n % 2)) for n in range(1, 40)))
    intent = progress.update(nav_at(0.0, 0.0), FRAME, CONFIG, 0.0)
    assert isinstance(intent, FollowLeg)
    assert [tuple(at) for at in intent.onward] == [
        pytest.approx((50.0 * n, 40.0 * (n % 2)), abs=0.01) for n in range(3, 19)
    ]


def test_a_waypoint_that_was_missed_where_the_way_turns_back_is_sailed_to_again() -> None:
    """The third waypoint is near the second, so the line leads from there to the fourth. The boat turns early
    and sails past the fourth without having been near the third.
    """
    back, onward = (26.7, 0.1), (15.0, -10.0)
    progress = mission((5.0, 3.0), (26.0, 0.0), back, onward, (31.0, -5.0))
    way = ((0.0, 0.0), (5.0, 3.0), (24.6, 0.2), (22.6, -1.2), (15.6, -9.6), (14.0, -10.9), (13.9, -11.0))
    intents = [progress.update(nav_at(*here), FRAME, CONFIG, 0.0) for here in way]
    legs = [intent for intent in intents if isinstance(intent, FollowLeg)]
    assert [leg.end for leg in legs[3:5]] == [pytest.approx(Point(*onward), abs=1e-6)] * 2
    assert [leg.end for leg in legs[5:]] == [pytest.approx(Point(*back), abs=1e-6)] * 2
    assert progress.current_seq == 3
