"""Ways through water where something was seen that no fence knows."""

import math
from itertools import pairwise

import pytest
from boat_rig import nav_at
from laid_fence import L_WATER, laid, square
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.geo import Line, Point, distance_m, path_length_m
from companion.core.steps import finished
from companion.geofence.fence import Fence
from companion.geofence.water_route import WaterRoute
from companion.obstacles.perception.voyage_map import VoyageMap
from companion.planning import visibility
from companion.vehicle.passage import Passage
from companion.vehicle.surroundings import Surroundings
from companion.vehicle.track import SailedTrack

CONFIG = BoatConfig()
HOME = Point(0.0, 0.0)


def wall(start: Point, end: Point) -> list[Point]:
    """Places a metre apart."""
    metres = round(distance_m(start, end))
    return [start.towards(end, number / metres) for number in range(metres + 1)]


class Water:
    """A fence, and what was seen in it."""

    def __init__(self, fence: Fence | None = None, track: list[Point] | None = None) -> None:
        self.seen: list[Point] = []
        self.voyage, self.track = VoyageMap(), SailedTrack()
        self.track.points = track or []
        self.around = Surroundings(fence or laid(), self.voyage, self.track)
        self.around.prepare(CONFIG.fence.margin_m)
        self.passage = Passage(self.around)
        self.now_s = 0.0

    def see(self, *places: Point) -> None:
        for at in places:
            self.voyage._add((math.floor(at.north_m), math.floor(at.east_m)), at)
            self.seen.append(at)

    def way(self, here: Point, goal: Point = HOME) -> WaterRoute:
        """After the search has ended."""
        self.now_s += 1.0
        for _ in range(200):
            self.passage.update(nav_at(*here), [goal], CONFIG, self.now_s)
        assert self.passage.way is not None
        return self.passage.way

    def corners(self, here: Point, goal: Point = HOME) -> list[Point]:
        return [here, *self.way(here, goal).corners_left]

    def clearance_m(self, corners: list[Point]) -> float:
        return min(from_line_m(one, other, at) for one, other in pairwise(corners) for at in self.seen)


def from_line_m(start: Point, end: Point, at: Point) -> float:
    along_m, cross_m = Line(start, end).along_and_cross_track_m(at)
    beyond_m = max(-along_m, along_m - distance_m(start, end), 0.0)
    return math.hypot(beyond_m, cross_m)


def test_where_nothing_is_seen_the_way_is_straight() -> None:
    water = Water()
    assert water.corners(Point(40.0, 0.0)) == [Point(40.0, 0.0), HOME]
    water.see(*wall(Point(20.0, 5.0), Point(20.0, 30.0)))
    assert water.corners(Point(40.0, 0.0)) == [Point(40.0, 0.0), HOME], "beside it"


@pytest.mark.parametrize("fence", [laid(), laid(square(100.0))], ids=["no fence", "fence"])
def test_a_wall_across_the_way_is_rounded_at_its_nearer_end(fence: Fence) -> None:
    water = Water(fence)
    here = Point(40.0, 0.0)
    assert len(water.corners(here)) == 2
    water.see(*wall(Point(20.0, -10.0), Point(20.0, 30.0)))
    corners = water.corners(here)
    assert min(corner.east_m for corner in corners) < -11.0
    assert 1.1 < water.clearance_m(corners) < 1.6, "one and a half margins, less the error of the outline"
    assert path_length_m(corners) < 46.5


def test_the_other_side_is_taken_where_the_wall_does_not_end_and_this_one_not_again() -> None:
    water = Water(laid(square(100.0)))
    water.see(*wall(Point(20.0, -8.0), Point(20.0, 12.0)))
    assert min(corner.east_m for corner in water.corners(Point(24.0, 0.0))) < -9.0
    water.see(*wall(Point(20.0, -97.0), Point(20.0, -8.0)))
    corners = water.corners(Point(24.0, -90.0))
    assert max(corner.east_m for corner in corners) > 13.0
    water.see(*wall(Point(20.0, 12.0), Point(20.0, 60.0)))
    assert max(corner.east_m for corner in water.corners(Point(24.0, 11.0))) > 61.0


def test_a_way_that_is_not_barred_is_not_planned_anew() -> None:
    water = Water()
    first = water.way(Point(40.0, 0.0))
    water.see(Point(20.0, 1.3))
    assert water.way(Point(38.0, 0.0)) is first, "the local planner passes it"
    water.see(Point(20.0, 0.3))
    assert water.way(Point(36.0, 0.0)) is not first


def test_what_bars_a_way_tells_for_the_voyage_that_the_chart_lacks_something() -> None:
    water = Water()
    told = []
    for north_m, east_m in ((40.0, 9.0), (38.0, 1.3), (36.0, 0.3)):
        water.see(Point(20.0, east_m))
        water.way(Point(north_m, 0.0))
        told.append(water.voyage.has_barred_a_way)
    water.passage.restart()
    told.append(water.voyage.has_barred_a_way)
    water.voyage.clear()
    told.append(water.voyage.has_barred_a_way)
    assert told == [False, False, True, True, False]


def test_the_present_way_is_kept_while_another_is_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(visibility, "TURN", 1)
    water = Water(laid(square(100.0)))
    here = Point(40.0, 0.0)
    first = water.way(here)
    water.see(*wall(Point(20.0, -90.0), Point(20.0, 30.0)), *wall(Point(10.0, -30.0), Point(10.0, 90.0)))
    water.passage.update(nav_at(*here), [HOME], CONFIG, water.now_s + 1.0)
    assert water.passage.way is first
    assert water.way(here) is not first


def test_nothing_is_checked_more_often_than_once_a_second() -> None:
    water = Water()
    here = Point(40.0, 0.0)
    first = water.way(here)
    water.see(*wall(Point(20.0, -5.0), Point(20.0, 5.0)))
    for _ in range(50):
        water.passage.update(nav_at(*here), [HOME], CONFIG, water.now_s + 0.9)
    assert water.passage.way is first


def test_from_beside_a_wall_the_way_leads_off_it_first() -> None:
    water = Water()
    here = Point(20.5, 0.0)
    water.see(*wall(Point(20.0, -10.0), Point(20.0, 30.0)))
    corners = water.corners(here)
    assert corners[1].north_m > 21.0
    assert water.clearance_m(corners[1:]) > 1.1


def test_a_boat_beside_a_rock_that_it_passes_is_not_sent_back() -> None:
    water = Water()
    water.way(Point(60.0, 0.0))
    water.see(*(Point(north_m, 0.2) for north_m in (19.5, 18.5, 17.5)))
    here = Point(20.5, 1.0)  # abeam of the rock, nearer than a way keeps
    corners = water.corners(here)
    assert corners[1].north_m < here.north_m
    assert path_length_m(corners) < 1.1 * distance_m(here, HOME)


def test_the_leg_to_sail_is_that_of_the_way() -> None:
    water, here = Water(), Point(40.0, 0.0)
    water.see(*wall(Point(20.0, -10.0), Point(20.0, 10.0)))
    way = water.way(here)
    assert water.passage.leg(nav_at(*here), [HOME], CONFIG, water.now_s) is way.leg
    assert way.leg.end != HOME


def test_a_boat_pressed_against_a_wall_goes_back_to_where_it_last_had_room() -> None:
    water = Water()
    water.way(Point(24.0, 0.0))
    water.see(*wall(Point(20.0, -10.0), Point(20.0, 30.0)))
    corners = water.corners(Point(20.4, 0.0))
    assert corners[1] == Point(24.0, 0.0)
    assert min(corner.east_m for corner in corners) < -11.0


@pytest.mark.parametrize(
    ("north_m_s", "east_m_s", "waits"), [(-1.5, 0.0, True), (-0.9, 0.0, False), (0.0, 1.5, False)]
)
def test_a_boat_that_comes_upon_something_brakes_before_another_way_is_searched(
    north_m_s: float, east_m_s: float, waits: bool
) -> None:
    water = Water()
    here = Point(22.0, 0.0)
    first = water.way(here)
    water.see(*wall(Point(20.0, -10.0), Point(20.0, 30.0)))
    moving = replace(nav_at(*here), north_m_s=north_m_s, east_m_s=east_m_s)
    for tick in range(50):
        water.passage.update(moving, [HOME], CONFIG, 10.0 + 0.1 * tick)
    assert (water.passage.way is first) is waits
    water.passage.update(nav_at(*here), [HOME], CONFIG, 15.0)
    assert water.passage.way is not first


def test_a_goal_beside_what_was_seen_is_reached() -> None:
    water = Water()
    water.see(*wall(Point(-0.5, -10.0), Point(-0.5, 10.0)))
    corners = water.corners(Point(-30.0, 0.0))
    assert corners[-1] == HOME
    assert corners[-2].north_m > 0.0, "from the free side"


def test_what_was_seen_closes_a_strait_of_the_fence() -> None:
    water = Water(laid(L_WATER))
    here = Point(60.0, 60.0)
    assert len(water.corners(here)) > 2
    water.see(*wall(Point(14.0, 20.0), Point(-14.0, 20.0)))
    water.now_s += 1.0
    way = finished(water.around.searching(here, [HOME], CONFIG))
    assert way is not None, "the map may be wrong: the local planner has the last word"
    assert way.seen_m == math.inf


def test_without_a_way_inside_the_fence_there_is_none() -> None:
    strait = laid(square(100.0), square(100.0))
    water = Water(strait)
    water.passage.update(nav_at(500.0, 0.0), [Point(0.0, 500.0)], CONFIG, 0.0)
    assert water.passage.way is not None or water.passage.has_failed


TRACK = [HOME, Point(0.0, 60.0), Point(80.0, 60.0), Point(80.0, 0.0)]


def test_once_something_barred_the_way_the_boat_goes_back_along_its_track() -> None:
    water = Water(track=TRACK)
    here = Point(80.0, 0.0)
    assert water.corners(here) == [here, HOME], "as long as the water is as it was thought"
    water.see(*wall(Point(70.0, -60.0), Point(70.0, 40.0)))
    corners = water.corners(Point(75.0, 0.0))
    assert corners[-4:] == [Point(80.0, 60.0), Point(0.0, 60.0), HOME, HOME]


def test_a_short_way_through_unseen_water_is_better_than_a_long_one_along_the_track() -> None:
    water = Water(track=[HOME, Point(0.0, 300.0), Point(80.0, 300.0), Point(80.0, 0.0)])
    assert len(water.corners(Point(80.0, 0.0))) == 2
    water.see(*wall(Point(70.0, -60.0), Point(70.0, 40.0)))
    assert max(corner.east_m for corner in water.corners(Point(75.0, 0.0))) < 45.0


def test_no_corner_of_the_track_is_cut() -> None:
    water = Water(track=TRACK)
    water.way(Point(80.0, 0.0))
    water.see(*wall(Point(70.0, -60.0), Point(70.0, 40.0)))
    way = water.way(Point(75.0, 0.0))
    turns = [way.leg.end]
    while not way.is_last:
        way._at += 1
        turns.append(way.corners_left[0])
    assert Point(80.0, 60.0) in turns
    assert Point(0.0, 60.0) in turns


def test_the_rest_of_the_way_is_as_long_as_its_legs() -> None:
    water = Water()
    water.see(*wall(Point(20.0, -10.0), Point(20.0, 30.0)))
    here = Point(40.0, 0.0)
    way = water.way(here)
    assert way.left_m(here) == pytest.approx(path_length_m([here, *way.corners_left]))
    assert way.left_m(here) > 40.5


@pytest.mark.parametrize(
    ("at", "is_planned_anew"),
    [((71.0, 38.0), False), ((66.0, 34.0), True)],
    ids=["near its leg", "off its leg"],
)
def test_a_boat_that_gave_way_to_something_is_led_on_from_where_it_is(
    at: tuple[float, float], is_planned_anew: bool
) -> None:
    water = Water()
    assert len(water.corners(Point(80.0, 0.0))) == 2
    water.see(*wall(Point(70.0, -60.0), Point(70.0, 40.0)))
    first = water.way(Point(72.0, 0.0))
    assert first.leg.end.east_m > 40.0
    assert (water.way(Point(*at)) is not first) is is_planned_anew


def test_a_corner_beside_what_was_seen_counts_as_passed_within_a_hull_s_length() -> None:
    water = Water(track=TRACK)
    water.way(Point(80.0, 0.0))
    water.see(*wall(Point(70.0, -60.0), Point(70.0, 40.0)))
    assert water.way(Point(75.0, 0.0)).leg.radius_m == pytest.approx(0.75)


GAP = wall(Point(20.0, 12.0), Point(20.0, 18.0))
BESIDE_GAP = [*wall(Point(20.0, -40.0), GAP[0]), *wall(GAP[-1], Point(20.0, 40.0))]


def farthest_east_m(water: Water, here: Point) -> float:
    return max(abs(corner.east_m) for corner in water.corners(here))


def test_a_dead_end_that_the_boat_turned_back_on_is_not_tried_again_until_there_is_no_other_way() -> None:
    water, here = Water(laid(square(60.0))), Point(30.0, 5.0)
    water.see(*BESIDE_GAP)
    assert farthest_east_m(water, here) < 18.0
    water.see(*GAP)
    assert farthest_east_m(water, here) > 40.0, "round the end"
    for at in GAP[1:-1]:
        del water.voyage._seen[math.floor(at.north_m), math.floor(at.east_m)]
    water.voyage.version += 1
    water.see(Point(21.0, 42.0), Point(21.0, -42.0))
    assert farthest_east_m(water, here) > 42.0, "the gap is open again"
    water.see(*wall(Point(21.0, 40.0), Point(21.0, 59.0)), *wall(Point(21.0, -59.0), Point(21.0, -40.0)))
    assert farthest_east_m(water, here) < 25.0, "nothing else is left"


def stay(water: Water, here: Point, seconds: float) -> None:
    """Under way to a goal, and held up there."""
    for _ in range(round(seconds)):
        water.now_s += 1.0
        water.passage.update(nav_at(*here), [HOME], CONFIG, water.now_s)


TWO_TRIES_S = 2.0 * CONFIG.avoidance.retry_s


def test_a_gap_that_the_boat_does_not_get_through_is_shut() -> None:
    water, here = Water(laid(square(60.0))), Point(24.0, 5.0)
    water.see(*BESIDE_GAP)
    assert farthest_east_m(water, here) < 18.0
    stay(water, here, TWO_TRIES_S - 1.0)
    assert farthest_east_m(water, here) < 18.0
    assert farthest_east_m(water, here) > 40.0


@pytest.mark.parametrize("leaves", ["for a mode", "for another goal"])
def test_time_in_which_the_boat_did_not_try_shuts_no_gap(leaves: str) -> None:
    water, here = Water(laid(square(60.0))), Point(24.0, 5.0)
    water.see(*BESIDE_GAP)
    assert farthest_east_m(water, here) < 18.0
    stay(water, here, TWO_TRIES_S - 5.0)
    if leaves == "for a mode":
        water.now_s += 10.0
    else:
        water.passage.aim_anew()
    stay(water, here, TWO_TRIES_S - 5.0)
    assert farthest_east_m(water, here) < 18.0


def test_a_boat_that_sails_on_is_in_no_dead_end() -> None:
    water = Water(laid(square(60.0)))
    water.see(*BESIDE_GAP)
    for seconds in range(70):
        stay(water, Point(58.0 - 0.5 * seconds, 5.0), 1.0)
    assert farthest_east_m(water, Point(23.0, 5.0)) < 18.0


def test_no_corner_is_shut_where_nothing_was_seen() -> None:
    water = Water(laid(L_WATER))
    first = water.way(HOME, Point(60.0, 60.0))
    for _ in range(round(TWO_TRIES_S) + 5):
        water.now_s += 1.0
        water.passage.update(nav_at(*HOME), [Point(60.0, 60.0)], CONFIG, water.now_s)
    assert water.passage.way is first


def test_a_track_that_does_not_lead_to_the_goal_is_no_way_back() -> None:
    water = Water(track=[Point(0.0, 0.0), Point(40.0, 0.0)])
    ring = [Point(20.0, 30.0).moved(math.radians(degrees), 10.0) for degrees in range(360)]
    water.see(*ring)
    water.passage._is_wary = True
    water.way(Point(40.0, 5.0), Point(20.0, 30.0))
    assert water.passage.is_shut
