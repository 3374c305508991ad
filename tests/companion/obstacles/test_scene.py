"""What avoidance decides from, by hand-calculated geometry."""

import math
from collections.abc import Sequence

import pytest
from boat_rig import nav_at
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import (
    FollowCircle,
    FollowLeg,
    HoldCourse,
    HoldHeading,
    HoldTurn,
    Intent,
    KeepStation,
    Stop,
)
from companion.core.state import NavState
from companion.geofence.fence import Fence
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.planning.detour import PORT, STARBOARD, Detour
from companion.obstacles.planning.detour_history import Breadcrumbs, DetourHistory
from companion.obstacles.planning.free_space import FreeSpace
from companion.obstacles.planning.scene import Scene
from companion.obstacles.planning.way_ahead import way_ahead

CONFIG = BoatConfig()
NORTH = HoldCourse(0.0, 1.5)


def scene_of(
    *obstacles: Point,
    intent: Intent = NORTH,
    nav: NavState | None = None,
    now_s: float = 0.0,
    reach_m: float = 4.0,
) -> Scene:
    perception = ObstaclePerception(CONFIG.avoidance)
    perception.reach_m = reach_m
    scene = Scene(intent, nav or nav_at(), CONFIG, perception, Fence(), now_s)
    scene.obstacles = scene.solid = list(obstacles)
    return scene


def moving(north_m_s: float, east_m_s: float = 0.0, **more: float) -> NavState:
    return replace(nav_at(), north_m_s=north_m_s, east_m_s=east_m_s, surge_m_s=north_m_s, **more)


def test_the_margin_grows_with_the_current_and_the_sight_is_the_sonars() -> None:
    assert scene_of().margin_m == pytest.approx(1.0)
    assert scene_of(nav=moving(0.0, current_north_m_s=0.3, current_east_m_s=-0.4)).margin_m == pytest.approx(
        1.4
    )
    assert scene_of(nav=moving(0.3, -0.4)).speed_m_s == pytest.approx(0.5)
    assert scene_of().sight_m == 4.0
    assert scene_of(reach_m=0.0).sight_m == CONFIG.avoidance.lookahead_m


def test_the_path_is_free_up_to_where_the_margin_touches() -> None:
    # 3 m ahead and 0.6 m aside, margin 1 m: it is entered √(1 − 0.36) = 0.8 m before
    scene = scene_of(Point(3.0, 0.6))
    assert scene.clear_path_m(scene.obstacles) == pytest.approx(2.2)
    assert scene.clear_path_m(scene.obstacles, share=0.5) == math.inf
    beyond = scene_of(Point(7.0, 0.0))
    assert beyond.clear_path_m(beyond.obstacles) == math.inf
    assert beyond.clear_path_m(beyond.obstacles, reaches=2.0) == pytest.approx(6.0)


def test_the_hull_has_room_on_a_course_up_to_six_tenths_of_the_margin() -> None:
    scene = scene_of(Point(3.0, 0.0), nav=moving(1.0))
    assert scene.room_m(0.0) == pytest.approx(2.4)
    assert scene.room_ahead_m() == pytest.approx(2.4)
    assert scene.room_m(0.5 * math.pi) == math.inf
    assert scene_of(Point(0.0, 3.0)).room_m(0.5 * math.pi) == pytest.approx(2.4)
    assert scene_of(Point(3.0, 0.0), nav=moving(0.09)).room_ahead_m() == math.inf, "at rest"
    assert scene_of(Point(0.0, -3.0), nav=moving(0.0, -1.0)).room_ahead_m() == pytest.approx(2.4)


@pytest.mark.parametrize(
    ("obstacles", "distance_m"),
    [
        ([Point(2.0, 0.0)], 2.0),
        ([Point(2.0, 1.9)], math.hypot(2.0, 1.9)),
        ([Point(2.0, 2.2)], math.inf),  # beyond 45°
        ([Point(2.0, -1.9)], math.hypot(2.0, 1.9)),
        ([Point(-2.0, 0.0)], math.inf),
        ([Point(3.0, 0.0), Point(2.0, 0.5)], math.hypot(2.0, 0.5)),
        ([], math.inf),
    ],
)
def test_the_nearest_obstacle_within_45_degrees_of_a_bearing(
    obstacles: list[Point], distance_m: float
) -> None:
    assert scene_of(*obstacles).nearest_m(0.0) == pytest.approx(distance_m)
    turned = [Point(-one.east_m, one.north_m) for one in obstacles]
    assert scene_of(*turned).nearest_m(0.5 * math.pi) == pytest.approx(distance_m)


def test_the_escape_is_straight_away_from_what_is_within_the_hulls_reach() -> None:
    assert scene_of().escape_course_rad() is None
    assert scene_of(Point(0.61, 0.0)).escape_course_rad() is None
    assert scene_of(Point(0.59, 0.0)).escape_course_rad() == pytest.approx(math.pi, abs=1e-9)
    both = scene_of(Point(0.5, 0.0), Point(0.0, 0.3))
    assert both.escape_course_rad() == pytest.approx(-0.5 * math.pi)


def test_the_stopping_speed_plans_half_of_the_room() -> None:
    # v = √((a t)² + 2 a d) − a t with a = 0.4 m/s², t = 1 s
    assert scene_of().stopping_speed_m_s(4.0) == pytest.approx(math.sqrt(0.16 + 1.6) - 0.4)


@pytest.mark.parametrize(
    ("heading", "surge_m_s", "stops"),
    [(1.1, 0.3, True), (-1.1, 0.3, True), (1.0, 0.3, False), (1.1, 0.19, False), (6.2, 0.3, False)],
)
def test_a_sharp_turn_under_way_is_made_after_a_stop(heading: float, surge_m_s: float, stops: bool) -> None:
    assert scene_of(nav=moving(surge_m_s)).must_stop_to_turn(heading) is stops


def test_a_stop_keeps_the_heading_unless_there_is_a_current_to_point_into() -> None:
    still = scene_of(nav=replace(nav_at(), heading_rad=0.7)).stop()
    assert still == HoldHeading(0.7, 0.0)
    weak = replace(nav_at(), heading_rad=0.7, current_east_m_s=0.15)
    assert scene_of(nav=weak).stop() == HoldHeading(0.7, 0.0)
    strong = replace(nav_at(), current_north_m_s=0.1, current_east_m_s=0.2)
    stop = scene_of(nav=strong).stop()
    assert stop.speed_m_s == 0.0
    assert stop.heading_rad == pytest.approx(math.atan2(-0.2, -0.1))


def test_the_heading_for_a_course_closes_the_velocity_triangle() -> None:
    scene = scene_of(nav=moving(0.0, current_north_m_s=0.2, current_east_m_s=0.5))
    heading = scene.heading_for_rad(0.3, 1.5)
    wanted = 1.5 * math.cos(0.3) - 0.2, 1.5 * math.sin(0.3) - 0.5
    assert (math.cos(heading), math.sin(heading)) == pytest.approx(
        (wanted[0] / math.hypot(*wanted), wanted[1] / math.hypot(*wanted))
    )


LEG = FollowLeg(Point(-10.0, 0.0), Point(30.0, 0.0), 1.2)


@pytest.mark.parametrize(
    ("intent", "course", "speed"),
    [
        (NORTH, 0.0, 1.5),
        (LEG, 0.0, 1.2),
        (FollowLeg(Point(-10.0, 3.0), Point(30.0, 3.0), 1.2), math.pi / 4.0, 1.2),  # 3 m off, 3 m ahead
        (HoldHeading(0.4, -0.6), 0.4 - math.pi, 0.6),
        (KeepStation(Point(0.0, 5.0)), math.pi / 2.0, 2.0),
        (KeepStation(Point(0.0, 0.9)), 0.0, 0.0),  # within the margin
        (HoldTurn(0.3, 0.0), 0.0, 0.0),
    ],
)
def test_the_course_and_speed_that_are_wanted(intent: Intent, course: float, speed: float) -> None:
    found = scene_of(intent=intent).desired_course_and_speed(None)
    assert math.remainder(found[0] - course, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert found[1] == pytest.approx(speed)
    assert scene_of(intent=intent).desired_course_and_speed(HoldCourse(0.9, 0.5)) == (0.9, 0.5)


def test_the_goal_is_the_end_of_what_is_sailed() -> None:
    assert scene_of(intent=LEG).goal() == LEG.end
    assert scene_of().goal() == pytest.approx((1000.0, 0.0))
    assert scene_of(intent=HoldHeading(math.pi / 2.0, 1.0)).goal() == pytest.approx((0.0, 1000.0))
    assert scene_of(intent=KeepStation(Point(3.0, 4.0))).goal() == Point(3.0, 4.0)
    circle = FollowCircle(Point(0.0, 10.0), 10.0, True, 1.0)
    assert math.dist(scene_of(intent=circle).goal(), circle.centre) == pytest.approx(10.0)


# The way ahead


@pytest.mark.parametrize(
    ("intent", "way"),
    [
        (KeepStation(Point(3.0, 4.0)), [(0.0, 0.0), (3.0, 4.0)]),
        (KeepStation(Point(0.0, 0.0)), [(0.0, 0.0)]),
        (HoldCourse(math.pi / 2.0, 1.0), [(0.0, 0.0), (0.0, 10.0)]),
        (HoldHeading(0.0, -1.0), [(0.0, 0.0), (-10.0, 0.0)]),
        (HoldHeading(0.0, 0.0), [(0.0, 0.0)]),
        (HoldTurn(0.5, 1.0), [(0.0, 0.0), (10.0, 0.0)]),
        (Stop(), [(0.0, 0.0)]),
        (LEG, [(0.0, 0.0), (0.0, 0.0), (30.0, 0.0)]),
        (
            FollowLeg(Point(-10.0, 1.0), Point(30.0, 1.0), 1.0, Point(30.0, 20.0)),
            [(0.0, 0.0), (2.0, 1.0), (30.0, 1.0), (30.0, 20.0)],  # twice as far along as it is off
        ),
        (
            FollowLeg(Point(-10.0, 5.0), Point(30.0, 5.0), 1.0),
            [(0.0, 0.0), (3.0, 5.0), (30.0, 5.0)],  # the lookahead at most
        ),
        (FollowLeg(Point(2.0, 0.0), Point(2.0, 0.0), 1.0), [(0.0, 0.0), (2.0, 0.0)]),
    ],
)
def test_the_way_ahead_of_an_intent(intent: Intent, way: Sequence[tuple[float, float]]) -> None:
    found = way_ahead(intent, nav_at(), CONFIG, 10.0)
    assert len(found) == len(way)
    for one, other in zip(found, way, strict=True):
        assert one == pytest.approx(other, abs=1e-9)


@pytest.mark.parametrize(("clockwise", "side"), [(True, 1.0), (False, -1.0)])
def test_the_way_round_a_circle_is_on_it_and_goes_its_way(clockwise: bool, side: float) -> None:
    circle = FollowCircle(Point(0.0, 10.0), 10.0, clockwise, 1.0)  # the boat is due west of the centre
    way = way_ahead(circle, nav_at(), CONFIG, 10.0)
    assert len(way) == 1 + math.ceil(10.0 / 3.5)
    for step, corner in enumerate(way[1:], 1):
        bearing = -math.pi / 2.0 + side * 0.35 * step
        assert corner == pytest.approx((10.0 * math.cos(bearing), 10.0 + 10.0 * math.sin(bearing)))
    assert len(way_ahead(circle, nav_at(), CONFIG, 1e6)) == 1 + math.ceil(math.tau / 0.35)


# Memory of the way


def test_the_last_place_with_room_is_where_the_boat_waits() -> None:
    crumbs = Breadcrumbs()
    for north_m in (0.0, 0.4, 0.6, 1.2, 1.8):
        crumbs.add(Point(north_m, 0.0), 1.0)
    here = Point(2.0, 0.0)
    assert crumbs.last_with_room(here, [], 1.0) == Point(1.8, 0.0)
    assert crumbs.last_with_room(here, [Point(2.0, 0.0)], 1.0) == Point(0.6, 0.0), "0.4 m was not dropped"
    assert crumbs.last_with_room(here, [Point(1.0, 0.0)], 5.0) == here


def test_only_so_many_places_are_remembered() -> None:
    crumbs = Breadcrumbs()
    for number in range(30):
        crumbs.add(Point(float(number), 0.0), 1.0)
    far = [Point(17.0, 0.0)]
    assert crumbs.last_with_room(Point(99.0, 0.0), far, 10.5) == Point(29.0, 0.0)
    assert crumbs.last_with_room(Point(99.0, 0.0), far, 12.5) == Point(99.0, 0.0)
    assert crumbs.last_with_room(Point(99.0, 0.0), [Point(20.0, 0.0)], 13.5) == Point(6.0, 0.0)


def test_a_detour_measures_its_way_and_its_gain() -> None:
    detour = Detour(Point(0.0, 0.0), Point(20.0, 0.0), STARBOARD, 0.5)
    detour.advance(Point(3.0, 4.0), 2.0)
    detour.advance(Point(3.0, 10.0), 2.0)
    assert detour.length_m == pytest.approx(11.0)
    assert detour.best_m == pytest.approx(math.hypot(17.0, 4.0))
    here = Point(10.0, 0.0)  # 10 m to go
    assert not detour.has_progressed(here, 0.0, 8.0)
    assert detour.has_progressed(here, 1.0, 8.0)
    assert not detour.has_progressed(Point(0.0, 0.0), 2.0, 1.0)


def test_a_detour_has_returned_once_it_had_left() -> None:
    detour = Detour(Point(1.0, 1.0), Point(20.0, 0.0), PORT, 0.5)
    assert not detour.has_returned(Point(1.0, 1.0), 2.0)
    detour.advance(Point(6.9, 1.0), 2.0)  # 5.9 m: within three scales
    assert not detour.has_returned(Point(1.0, 1.0), 2.0)
    detour.advance(Point(7.1, 1.0), 2.0)
    assert not detour.has_returned(Point(3.1, 1.0), 2.0)
    assert detour.has_returned(Point(2.9, 1.0), 2.0)


def test_a_reversed_detour_goes_back_on_the_other_side() -> None:
    detour = Detour(Point(0.0, 0.0), Point(20.0, 0.0), STARBOARD, 0.5)
    detour.reverse()
    assert detour.side == PORT
    assert detour.course_rad == pytest.approx(0.5 - math.pi)


def water_of(*obstacles: Point) -> FreeSpace:
    return FreeSpace(Point(0.0, 0.0), obstacles, 1.0, 4.0)


GOAL = Point(20.0, 0.0)


def test_the_first_detour_takes_the_smaller_turn_and_is_remembered() -> None:
    history = DetourHistory()
    assert (history.last_side, history.has_tried(PORT), history.has_tried(STARBOARD)) == (0, False, False)
    detour = history.start_detour(Point(0.0, 0.0), GOAL, water_of(Point(3.0, 0.8)), 4.0, 1.0)
    assert detour is not None
    assert (detour.side, detour.met, detour.goal) == (PORT, Point(0.0, 0.0), GOAL)
    assert (history.last_side, history.has_tried(PORT), history.has_tried(STARBOARD)) == (PORT, True, False)


def test_a_side_is_kept_until_the_goal_is_two_margins_nearer() -> None:
    starboard_is_shorter = water_of(Point(3.0, -0.8))
    for north_m, side in ((1.9, PORT), (2.1, STARBOARD)):
        history = DetourHistory()
        history.start_detour(Point(0.0, 0.0), GOAL, water_of(Point(3.0, 0.8)), 4.0, 1.0)
        history.detour_length_m = 5.0
        detour = history.start_detour(Point(north_m, 0.0), GOAL, starboard_is_shorter, 4.0, 1.0)
        assert detour is not None
        assert detour.side == side
        assert history.detour_length_m == (5.0 if side == PORT else 0.0)


def test_a_side_that_led_back_to_its_start_is_not_taken_again() -> None:
    history, water = DetourHistory(), water_of(Point(3.0, 0.8))
    sides = []
    for _ in range(2):
        detour = history.start_detour(Point(0.0, 0.0), GOAL, water, 4.0, 1.0)
        assert detour is not None
        sides.append(detour.side)
    assert sides == [PORT, STARBOARD]
    assert history.start_detour(Point(0.0, 0.0), GOAL, water, 4.0, 1.0) is None
    elsewhere = history.start_detour(Point(0.0, 1.6), GOAL, water, 4.0, 1.0)
    assert elsewhere is not None, "1.6 margins away is another start"


def test_a_new_goal_clears_the_history() -> None:
    history = DetourHistory()
    history.start_detour(Point(0.0, 0.0), GOAL, water_of(Point(3.0, 0.8)), 4.0, 1.0)
    history.detour_length_m = 9.0
    history.forget()
    assert (history.last_side, history.detour_length_m, history.has_tried(PORT)) == (0, 0.0, False)


@pytest.mark.parametrize(("north_m", "east_m"), [(30.0, -20.0), (-7.0, 12.0)])
def test_the_nearest_obstacle_is_nearest_to_where_the_boat_is(north_m: float, east_m: float) -> None:
    """And not to where its frame begins."""
    ahead = Point(north_m + 3.0, east_m + 1.0), Point(north_m + 8.0, east_m)
    scene = scene_of(*ahead, nav=nav_at(north_m, east_m))
    assert scene.nearest_m(0.0) == pytest.approx(math.sqrt(10.0))
