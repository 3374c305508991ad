"""The way onto a mission: straight where the water allows it, else round the shore."""

import math

import pytest
from boat_rig import FRAME, nav_at, place
from fence_rig import box
from laid_fence import L_WATER, area, circle, laid, square
from mode_inputs import around

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import FollowLeg, HoldCourse, Intent, KeepStation
from companion.core.status_text import StatusText
from companion.geofence.fence import FenceArea
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.mission.route_to_mission import RouteToMission
from companion.vehicle.mission.steps import Home, SetSpeed, Waypoint
from companion.vehicle.return_route import ReturnRoute

CONFIG = BoatConfig()


class Boat:
    """At a place inside a fence, with a mission of one waypoint."""

    def __init__(self, here: Point, end: tuple[float, float], *areas: FenceArea) -> None:
        self.texts: list[StatusText] = []
        self.sailed_s = 0.0
        surroundings = around(laid(*areas))
        self.surroundings = surroundings
        route = ReturnRoute(surroundings, [])
        self.nav = nav_at(*here)
        self.route = route
        self.progress = MissionProgress()
        self.progress.replace((Home(), Waypoint(place(*end))))
        self.route_to_mission = RouteToMission(surroundings, self.texts)

    def prepare(self) -> "Boat":
        """Two ticks of the route home, which index the water."""
        for _ in range(2):
            self.route.prepare(FRAME, place(0.0, 0.0), CONFIG)
        return self

    def sail(self, now_s: float = 0.0) -> tuple[Intent, Intent]:
        """What the mission wants, and what is sailed instead."""
        wanted = self.progress.update(self.nav, FRAME, CONFIG, now_s)
        return wanted, self.route_to_mission.update(wanted, self.progress, self.nav, CONFIG, now_s)

    def see(self, east_m: int) -> None:
        """Something in the water, 20 m north."""
        self.surroundings.voyage._add((20, east_m), Point(20.5, east_m + 0.5))


@pytest.mark.parametrize("here", [Point(0.0, 0.0), Point(13.5, 0.0)])
def test_a_way_over_land_is_sailed_round_by_the_water(here: Point) -> None:
    boat = Boat(here, (60.0, 60.0), L_WATER)
    _, first = boat.sail()
    assert first == KeepStation(here), "until the way is known"
    boat.prepare()
    _, sailed = boat.sail()
    assert isinstance(sailed, FollowLeg)
    assert sailed.start == here
    assert sailed.end.north_m < 15.0, "along the southern arm first"
    assert [text.text for text in boat.texts] == ["The way to the mission leads round the shore"]


@pytest.mark.parametrize(
    ("end", "text"),
    [
        ((60.0, 0.0), "The way to the mission leads near the fence"),  # straight through the gap
        ((60.0, 30.0), "The way to the mission leads round the shore"),  # the straight line is over a wall
    ],
)
def test_a_narrow_passage_is_taken_where_the_straight_line_leaves_the_water(
    end: tuple[float, float], text: str
) -> None:
    walls = [area(box(20.0, *ends), is_inclusion=False) for ends in ((-60.0, 24.0, -2.0), (2.0, 24.0, 60.0))]
    boat = Boat(Point(0.0, 0.0), end, area(box(-20.0, -50.0, 80.0, 50.0)), *walls)
    boat.prepare()
    boat.sail()
    assert [said.text for said in boat.texts] == [text]


def is_open(here: tuple[float, float], end: tuple[float, float], island: FenceArea) -> bool:
    """Whether the mission's own leg is sailed, with the water not indexed as yet."""
    nav, surroundings = nav_at(*here), around(laid(square(50.0), island))
    progress = MissionProgress()
    progress.replace((Home(), SetSpeed(1.0), Waypoint(place(*end))))
    wanted = progress.update(nav, FRAME, CONFIG, 0.0)
    assert isinstance(wanted, FollowLeg)
    sailed = RouteToMission(surroundings, []).update(wanted, progress, nav, CONFIG, 0.0)
    assert sailed is wanted or sailed == KeepStation(Point(*here))
    return sailed is wanted


@pytest.mark.parametrize("turn", [0, 1])
@pytest.mark.parametrize(
    ("here", "end", "expected"),
    [
        ((0.0, -40.0), (0.0, 10.0), True),
        ((0.0, -40.0), (0.0, 40.0), False),  # over the island
        ((8.1, -40.0), (8.1, 40.0), True),  # 3.1 m from it
        ((7.7, -40.0), (7.7, 40.0), False),  # 2.7 m from it: less than 0.95 of the clearance
        ((6.5, -49.5), (6.5, 40.0), False),  # a berth may be left, but the island is as far off as ever
        ((8.1, -49.5), (8.1, 40.0), True),
        ((-49.5, -20.0), (40.0, -20.0), True),  # straight out of a berth
        ((-49.5, -20.0), (-20.0, 10.0), True),
        ((-49.0, -46.0), (-49.0, -49.0), True),  # from berth to berth, in a corner
        ((-49.0, 10.0), (-49.0, 14.0), True),
    ],
)
def test_the_straight_line_is_open_where_it_keeps_the_clearance_once_the_berth_is_left(
    turn: int, here: tuple[float, float], end: tuple[float, float], expected: bool
) -> None:
    centre = (0.0, 20.0)
    for _ in range(turn):
        here, end, centre = (-here[1], here[0]), (-end[1], end[0]), (-centre[1], centre[0])
    assert is_open(here, end, circle(*centre, 5.0)) is expected


def test_what_is_no_leg_or_does_not_begin_at_the_boat_is_left_as_it_is() -> None:
    surroundings = around(laid(square(50.0), circle(0.0, 20.0, 5.0)))
    route, progress = RouteToMission(surroundings, []), MissionProgress()
    station, nav = KeepStation(Point(1.0, 2.0)), nav_at(0.0, -40.0)
    assert route.update(station, progress, nav, CONFIG, 0.0) is station
    progress.replace((Home(), Waypoint(place(0.0, 40.0))))
    leg = progress.update(nav, FRAME, CONFIG, 0.0)
    assert route.update(leg, progress, nav, CONFIG, 0.0) == KeepStation(nav.point)
    course = HoldCourse(0.0, 1.0)
    assert route.update(course, progress, nav, CONFIG, 0.0) is course
    progress.begin_leg_at(Point(0.0, -40.0))
    leg = progress.update(nav, FRAME, CONFIG, 0.0)
    assert route.update(leg, progress, nav, CONFIG, 0.0) is leg


def test_what_is_seen_on_the_way_to_the_first_waypoint_leads_to_another_route() -> None:
    boat = Boat(Point(0.0, 0.0), (60.0, 0.0)).prepare()
    wanted, sailed = boat.sail()
    assert sailed is wanted
    for east_m in range(-30, 40):
        boat.see(east_m)
    ends = []
    for second in range(1, 60):
        _, sailed = boat.sail(float(second))
        assert isinstance(sailed, FollowLeg)
        assert not boat.surroundings.voyage.bars(boat.nav.point, sailed.end, 0.9, ())
        ends.append(sailed.end)
        boat.nav = nav_at(*sailed.end)
        if sailed.end.north_m > 55.0:
            break
    assert min(end.east_m for end in ends) < -30.5
    assert ends[-1] == pytest.approx((60.0, 0.0), abs=1e-3)
    assert boat.progress.loose_leg is None, "the rest is the mission's own leg"


def test_what_is_rounded_within_sight_is_left_to_the_local_planner() -> None:
    boat = Boat(Point(0.0, 0.0), (60.0, 0.0)).prepare()
    boat.sail()
    boat.see(0)
    for second in range(1, 5):
        wanted, sailed = boat.sail(float(second))
        assert sailed is wanted


def test_a_corner_that_the_local_planner_has_passed_is_not_sailed_back_to() -> None:
    boat = Boat(Point(0.0, 0.0), (60.0, 0.0)).prepare()
    boat.sail()
    boat.see(0)
    for now_s in (1.0, 1.1, 1.2, 1.3):
        if now_s > 1.2:  # before the way is checked again
            boat.nav = nav_at(30.0, 1.0)
        wanted, sailed = boat.sail(now_s)
        assert sailed is wanted


def test_on_a_later_leg_a_wall_is_rounded_when_it_is_in_sight() -> None:
    boat = Boat(Point(0.0, 0.0), (60.0, 0.0)).prepare()
    boat.progress.begin_leg_at(Point(0.0, 0.0))
    for east_m in range(-12, 12):
        boat.see(east_m)
    wanted, sailed = boat.sail()
    assert sailed is wanted
    boat.nav = nav_at(14.0, 0.0)
    for second in range(1, 6):
        _, sailed = boat.sail(float(second))
    assert isinstance(sailed, FollowLeg)
    assert abs(sailed.end.east_m) > 12.0
    assert boat.route_to_mission.left_m(boat.nav.point) is not None


RETRY_S = CONFIG.avoidance.retry_s


def shut_in(*behind: Waypoint) -> Boat:
    """A boat beside a waypoint with a wall all round."""
    boat = Boat(Point(0.0, 0.0), (60.0, 0.0)).prepare()
    boat.progress.replace((Home(), Waypoint(place(30.0, 0.0)), *behind))
    for degrees in range(360):
        at = Point(30.0, 0.0).moved(math.radians(degrees), 12.0)
        boat.surroundings.voyage._add((math.floor(at.north_m), math.floor(at.east_m)), at)
    boat.nav = nav_at(14.0, 0.0)
    return boat


def after(boat: Boat, seconds: float) -> list[Intent]:
    """What is sailed in each cycle."""
    start_s = boat.sailed_s
    boat.sailed_s += seconds
    return [boat.sail(start_s + 0.1 * step)[1] for step in range(round(10.0 * seconds))]


def test_a_waypoint_that_is_shut_in_is_waited_for_then_skipped_and_the_next_line_begins_there() -> None:
    boat = shut_in(Waypoint(place(80.0, 0.0)))
    waits = [one for one in after(boat, RETRY_S - 1.0) if isinstance(one, KeepStation)]
    assert waits
    assert set(waits) == {KeepStation(boat.nav.point)}
    assert boat.progress.current_seq == 1
    assert [one.text for one in boat.texts] == ["No way to item 1 round what was seen: waiting"]
    after(boat, 6.0)
    assert [one.text for one in boat.texts[1:]] == ["No way to item 1: skipped"]
    assert boat.progress.current_seq == 2
    line = boat.progress.leg_line()
    assert line is not None
    assert line.start == pytest.approx((30.0, 0.0), abs=1e-3)
    assert boat.progress.take_reached() == []


def test_a_last_waypoint_that_is_shut_in_is_not_skipped() -> None:
    boat = shut_in()
    after(boat, RETRY_S + 20.0)
    assert [one.text for one in boat.texts] == ["No way to item 1 round what was seen: waiting"]
    assert not boat.progress.finished


def test_a_waypoint_that_opens_while_the_boat_waits_is_sailed_to() -> None:
    boat = shut_in(Waypoint(place(80.0, 0.0)))
    after(boat, RETRY_S - 1.0)
    boat.surroundings.voyage.clear()
    assert isinstance(after(boat, 6.0)[-1], FollowLeg)
    assert boat.progress.current_seq == 1
    assert len(boat.texts) == 1


def test_a_mission_that_is_begun_again_waits_again() -> None:
    boat = shut_in(Waypoint(place(80.0, 0.0)))
    after(boat, RETRY_S - 1.0)
    boat.progress.resume()
    after(boat, 5.0)
    assert boat.progress.current_seq == 1
    assert [one.text for one in boat.texts] == 2 * ["No way to item 1 round what was seen: waiting"]
