"""The side on which an obstacle without a known end is passed."""

import math

import pytest
from avoidance_rig import CONFIG, LEG, ROCK, WALL, Voyage, boat

from companion.core.geo import Point
from companion.core.intent import Drive, FollowLeg, HoldHeading
from companion.obstacles.perception.occupancy import SWEEP_S
from companion.obstacles.planning.clearance import UNSEEN, ClearanceField
from companion.obstacles.planning.cost_to_go import CostToGo
from companion.obstacles.planning.detour import Detour

HERE, WALL_AT, SIGHT_M = Point(0.0, 0.0), Point(3.0, 0.0), 4.0
GOAL = Point(50.0, 0.0)


def to_go(*solid: Point, seen: bool = True, shuts: Detour | None = None) -> CostToGo:
    field = ClearanceField(HERE, 0.2, 9.0)
    field.look(lambda norths_m, easts_m: [[seen for _ in easts_m] for _ in norths_m])
    field.fill(list(solid), list(solid), 0.35)
    return CostToGo(field, HERE, GOAL, 1.0, 0.6, shuts.shuts if shuts else None)


def begun(side_m: float = 0.0, course_rad: float = 0.0) -> Detour:
    side = Detour()
    side.is_too_long(HERE, 80.0, 0.4, 0.0, is_certain=True)
    side.begin(WALL_AT.moved(0.5 * math.pi, side_m), course_rad, SIGHT_M, 0.0)
    return side


def wall(west_m: float, east_m: float) -> list[Point]:
    return [Point(3.0, west_m + 0.2 * step) for step in range(round((east_m - west_m) / 0.2) + 1)]


@pytest.mark.parametrize(("west_m", "east_m", "side"), [(-5.0, 2.0, 1), (-2.0, 5.0, -1)])
def test_after_a_full_sweep_the_shorter_way_is_taken(west_m: float, east_m: float, side: int) -> None:
    choice, way = begun(), to_go(*wall(west_m, east_m))
    assert not choice.update(HERE, way, SWEEP_S - 0.01)
    assert (choice.side, choice.is_new(SWEEP_S - 0.01)) == (0, True)
    assert choice.update(HERE, way, SWEEP_S + 0.01)
    assert (choice.side, choice.is_new(SWEEP_S + 0.01)) == (side, False)
    assert not choice.update(HERE, way, SWEEP_S + 1.0), "it was chosen already"


def test_a_wall_without_an_end_is_followed_for_a_sight_then_twice_as_far_to_the_other_side() -> None:
    choice, way = begun(), to_go(*wall(-5.0, 2.0))
    choice.update(HERE, way, 2.0)
    assert not choice.update(Point(1.0, SIGHT_M - 0.1), way, 9.0)
    assert choice.update(Point(1.0, SIGHT_M + 0.1), way, 9.0)
    assert choice.side == -1
    assert not choice.update(Point(1.0, -2.0 * SIGHT_M + 0.1), way, 20.0)
    assert choice.update(Point(1.0, -2.0 * SIGHT_M - 0.1), way, 20.0)
    assert choice.side == 1


def test_what_is_shut_lies_before_the_wall_on_the_other_side() -> None:
    choice = begun()
    choice.update(HERE, to_go(*wall(-5.0, 2.0)), 2.0)
    assert choice.shuts(2.0, -1.0)
    assert not choice.shuts(2.0, 1.0)
    assert not choice.shuts(4.0, -1.0)
    assert not begun().shuts(2.0, -1.0), "no side was chosen"
    assert choice.is_before(Point(2.9, 0.0))
    assert not choice.is_before(Point(3.1, 0.0))
    assert not Detour().is_before(HERE)


def test_the_first_obstacle_counts_until_it_is_passed() -> None:
    choice = begun()
    choice.begin(Point(30.0, 0.0), 0.0, SIGHT_M, 1.0)
    assert not choice.is_before(Point(4.0, 0.0))


def test_a_side_is_told_from_the_way_to_the_goal() -> None:
    east = Detour()
    east.begin(Point(0.0, 3.0), math.pi / 2, SIGHT_M, 0.0)
    south = [Point(-5.0 + 0.2 * step, 3.0) for step in range(31)]  # the wall reaches from -5 m to 1 m north
    field = ClearanceField(HERE, 0.2, 9.0)
    field.fill(south, south, 0.35)
    east.update(HERE, CostToGo(field, HERE, Point(0.0, 50.0), 1.0, 0.6), 2.0)
    assert east.side == -1
    assert east.shuts(-1.0, 2.0)
    assert not east.shuts(1.0, 2.0)


def test_water_that_no_ranger_has_seen_costs_twice_as_much() -> None:
    assert to_go(seen=False).at(0.0, 0.0) > 1.3 * to_go(seen=True).at(0.0, 0.0)


def test_over_unseen_water_no_way_leads_to_the_side_that_is_shut() -> None:
    choice = begun()
    choice.update(HERE, to_go(*wall(-9.0, 2.0)), 2.0)
    open_m, shut_m = (
        to_go(*WALL, seen=False).at(1.0, -2.0),
        to_go(*WALL, seen=False, shuts=choice).at(1.0, -2.0),
    )
    assert choice.side == 1
    assert shut_m > open_m
    seen_m = to_go(*wall(-5.0, 9.0), shuts=choice).at(1.0, -2.0)
    assert seen_m == pytest.approx(to_go(*wall(-5.0, 9.0)).at(1.0, -2.0)), "water seen free stays open"


def test_cells_that_were_not_seen_are_marked() -> None:
    field = ClearanceField(HERE, 0.2, 4.0)
    field.look(lambda norths_m, easts_m: [[at_m > 0.0 for _ in easts_m] for at_m in norths_m])
    field.fill([], [], 0.35)
    assert field.at(1.0, 1.0) == 0
    assert field.at(-1.0, 1.0) == UNSEEN
    field.fill([Point(2.0, 2.0)], [Point(2.0, 2.0)], 0.35)
    assert field.at(-3.0, -3.0) & UNSEEN
    assert not field.at(2.0, 2.0) & UNSEEN


def test_until_its_extent_is_known_the_boat_slows_down_on_its_heading() -> None:
    voyage = Voyage(*ROCK)
    found = voyage.at(0.0, boat(speed_m_s=1.5), LEG)
    assert isinstance(found, Drive) or (isinstance(found, HoldHeading) and abs(found.heading_rad) < 0.3)
    assert voyage.said == []
    voyage.after_a_sweep(intent=LEG)
    assert voyage.said == ["Obstacle: passing to starboard"]


def test_the_side_is_told_once_a_thing() -> None:
    voyage = Voyage(*ROCK)
    voyage.after_a_sweep(intent=LEG)
    for step in range(50):
        voyage.at(2.0 + 0.1 * step, intent=LEG)
    assert voyage.said == ["Obstacle: passing to starboard"]


@pytest.mark.parametrize(
    ("pause_s", "next_one", "told"),
    [
        (2.0, ROCK, []),
        (2.0, [Point(3.0, 0.7 + 0.2 * step) for step in range(10)], ["Obstacle: passing to port"]),
        (9.5, ROCK, []),
        (10.5, ROCK, ["Obstacle: passing to starboard"]),
    ],
)
def test_what_follows_soon_on_the_same_side_is_told_with_the_thing_before_it(
    pause_s: float, next_one: list[Point], told: list[str]
) -> None:
    voyage = Voyage(*ROCK)
    voyage.after_a_sweep(intent=LEG)
    voyage.chart.rocks = [Point(at.north_m + 6.0, at.east_m) for at in next_one]
    voyage.now_s += pause_s - SWEEP_S
    voyage.after_a_sweep(boat(6.0), LEG)
    assert voyage.said == ["Obstacle: passing to starboard", *told]


@pytest.mark.parametrize("speed_m_s", [0.5, 1.0, 1.7])
def test_a_path_that_meets_something_is_not_kept(speed_m_s: float) -> None:
    config = CONFIG
    voyage = Voyage(*WALL, config=config)
    assert voyage.after_a_sweep(boat(speed_m_s=speed_m_s), LEG) is not LEG


@pytest.mark.parametrize(("course_deg", "is_kept"), [(0.0, True), (55.0, True), (-55.0, True), (65.0, False)])
def test_a_side_outlives_a_new_goal_behind_the_same_obstacle(course_deg: float, is_kept: bool) -> None:
    choice, way = begun(), to_go(*wall(-5.0, 2.0))
    choice.update(HERE, way, 2.0)
    choice.aim(math.radians(course_deg))
    assert (choice.side, choice.is_before(HERE)) == ((1, True) if is_kept else (0, False))


def test_a_new_goal_near_by_does_not_tell_the_side_again() -> None:
    voyage = Voyage(*ROCK)
    voyage.after_a_sweep(intent=LEG)
    for step in range(20):
        voyage.at(2.0 + 0.1 * step, intent=FollowLeg(Point(0.0, 0.0), Point(12.0 + step, 2.0), 1.0))
    assert voyage.said == ["Obstacle: passing to starboard"]


def test_behind_the_obstacle_the_detour_ends() -> None:
    choice = begun()
    choice.update(HERE, to_go(*wall(-5.0, 2.0)), 2.0)
    for at, side in ((Point(2.9, 3.0), 1), (Point(3.1, 3.0), 0)):
        choice.is_too_long(at, 80.0, 0.4, 3.0, is_certain=True)
        assert choice.side == side


@pytest.mark.parametrize(
    ("now_s", "north_m", "is_long"), [(200.9, 79.0, False), (201.1, 79.0, True), (201.1, 81.0, False)]
)
def test_a_detour_is_too_long_by_the_time_that_the_boat_stays_near(
    now_s: float, north_m: float, is_long: bool
) -> None:
    choice = Detour()
    for tenth in range(10, round(10.0 * now_s)):
        assert not choice.is_too_long(HERE, 80.0, 0.4, 0.1 * tenth, is_certain=True)
    at = Point(north_m, 0.0)
    assert choice.is_too_long(at, 80.0, 0.4, now_s, is_certain=True) is is_long
    assert not choice.is_too_long(at, 80.0, 0.4, now_s, is_certain=False), "nothing is near"
    assert not choice.is_too_long(at, 80.0, 0.4, now_s, is_certain=True), "it begins anew"


def test_the_time_among_obstacles_begins_anew_after_two_sweeps_in_open_water() -> None:
    """In open water the planner asks nothing: what it met an hour ago is no long detour."""
    for gap_s, is_long in ((2.9, True), (3.1, False)):
        choice = Detour()
        for second in range(200):
            assert not choice.is_too_long(HERE, 80.0, 0.4, float(second), is_certain=True)
        assert choice.is_too_long(HERE, 80.0, 0.4, 199.0 + gap_s, is_certain=True) is is_long
