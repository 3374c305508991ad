"""The fence brake against v = √((a t)² + 2 a d) − a t, with a = 0.4 m/s², t = 1 s, d half of the room left.

The water is a square of 100 m, the margin 2 m. The room left is the way to the line less the margin.
"""

import math

import pytest
from fence_rig import box
from laid_fence import area, laid, square
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, decode_config, with_value
from companion.core.geo import Point
from companion.core.intent import Drive, FollowLeg, HoldCourse, Intent, KeepStation, Stop
from companion.core.state import Demand, NavState
from companion.core.status_text import Severity, StatusText
from companion.geofence.brake import FenceBrake
from companion.geofence.fence import Fence

CONFIG = BoatConfig()
NORTHWARD = Demand(0.0, 2.0, 0.3, 7.0, 0.01)


def allowed_m_s(room_left_m: float) -> float:
    return math.sqrt(0.16 + 2.0 * 0.4 * 0.5 * room_left_m) - 0.4


def nav_at(
    north_m: float,
    north_m_s: float = 0.0,
    *,
    east_m: float = 0.0,
    east_m_s: float = 0.0,
    heading: float = 0.0,
    current: tuple[float, float] = (0.0, 0.0),
    age_s: float = 0.1,
) -> NavState:
    surge = north_m_s * math.cos(heading) + east_m_s * math.sin(heading)
    return NavState(
        0.0, north_m, east_m, heading, 0.0, north_m_s, east_m_s, surge, 0.0, age_s, 0.1,
        current_north_m_s=current[0], current_east_m_s=current[1],
    )  # fmt: skip


def limited(
    steered: Demand | Drive | Stop,
    nav: NavState | None,
    *,
    config: BoatConfig = CONFIG,
    fence: Fence | None = None,
    intent: Intent = Stop(),  # noqa: B008
) -> Demand | Drive | Stop:
    return FenceBrake([]).limit(steered, intent, nav, fence or laid(square(50.0)), config, 0.1)


def speed_of(steered: Demand | Drive | Stop) -> float:
    assert isinstance(steered, Demand)
    return steered.speed_m_s


# How fast


@pytest.mark.parametrize("room_m", [4.0, 12.0])
def test_toward_a_line_the_boat_keeps_the_speed_that_it_can_lose_in_half_of_the_room(room_m: float) -> None:
    braked = limited(NORTHWARD, nav_at(50.0 - room_m, 2.0))
    assert speed_of(braked) == pytest.approx(allowed_m_s(room_m - 2.0), abs=1e-3)
    assert isinstance(braked, Demand)
    assert replace(braked, speed_m_s=2.0) == NORTHWARD, "nothing else changes"


@pytest.mark.parametrize("heading", [-0.5 * math.pi, math.pi])
def test_a_line_abeam_or_astern_does_not_slow_the_boat(heading: float) -> None:
    nav = nav_at(47.0, 2.0 * math.cos(heading), east_m_s=2.0 * math.sin(heading), heading=heading)
    demand = Demand(heading, 2.0)
    assert limited(demand, nav) is demand


def test_astern_it_brakes_for_the_line_astern() -> None:
    braked = limited(Demand(0.0, -1.0), nav_at(-44.0, -1.0))
    assert speed_of(braked) == pytest.approx(-allowed_m_s(4.0), abs=1e-3)


@pytest.mark.parametrize(("room_m", "speed_m_s"), [(1.5, -0.2), (1.25, -0.3), (0.5, -0.4)])
def test_within_the_margin_it_backs_off_by_its_depth_and_no_faster_than_steerage_way(
    room_m: float, speed_m_s: float
) -> None:
    braked = limited(NORTHWARD, nav_at(50.0 - room_m))
    assert speed_of(braked) == pytest.approx(speed_m_s, abs=1e-3)


def test_the_current_takes_two_seconds_of_the_room_and_counts_only_toward_the_line() -> None:
    with_it = limited(NORTHWARD, nav_at(38.0, 2.0, current=(0.5, 0.0)))
    assert speed_of(with_it) == pytest.approx(allowed_m_s(9.0), abs=1e-3)
    against = limited(NORTHWARD, nav_at(38.0, 2.0, current=(-0.5, 0.0)))
    assert speed_of(against) == pytest.approx(allowed_m_s(10.0), abs=1e-3)


def test_the_course_made_good_counts_even_where_another_one_is_asked_for() -> None:
    # Asked for the north-east line's direction east; still makes 2 m/s north-east toward the north line
    nav = nav_at(44.0, 1.5, heading=math.radians(80.0), east_m_s=0.5)
    demand = Demand(math.radians(100.0), 2.0)
    along = math.cos(math.radians(100.0)) * 1.5 + math.sin(math.radians(100.0)) * 0.5
    assert along > 0.1
    way_m = 6.0 * math.hypot(1.5, 0.5) / 1.5
    assert speed_of(limited(demand, nav)) == pytest.approx(allowed_m_s(way_m - 2.0), abs=1e-3)


# When not


def test_without_position_fence_or_permission_everything_goes_through() -> None:
    near = nav_at(49.0, 2.0)
    assert limited(NORTHWARD, near) != NORTHWARD
    assert limited(NORTHWARD, None) is NORTHWARD
    assert limited(NORTHWARD, near, fence=laid()) is NORTHWARD
    assert limited(Stop(), near) == Stop()
    assert limited(NORTHWARD, replace(near, position_age_s=3.1)) is NORTHWARD
    assert limited(NORTHWARD, replace(near, position_age_s=2.9)) != NORTHWARD
    for enable, brakes in ((0, False), (2, False), (1, True), (3, True)):
        config = with_value(CONFIG, "avoidance.enable", enable)
        assert (limited(NORTHWARD, near, config=config) != NORTHWARD) is brakes


# By hand. Full throttle makes 3.33 m/s; the feed-forward is 0.3 per m/s


def throttle_of(steered: Demand | Drive | Stop) -> float:
    assert isinstance(steered, Drive)
    return steered.throttle


def throttle_for(speed_m_s: float, surge_m_s: float) -> float:
    return 0.3 * speed_m_s + CONFIG.speed.kp * (speed_m_s - surge_m_s)


def test_by_hand_the_throttle_is_what_holds_the_allowed_speed() -> None:
    allowed = allowed_m_s(10.0)
    braked = limited(Drive(1.0, 0.3), nav_at(38.0, 1.6))
    assert throttle_of(braked) == pytest.approx(throttle_for(allowed, 1.6), abs=2e-3)
    assert isinstance(braked, Drive)
    assert braked.steering == 0.3
    astern = limited(Drive(-1.0, 0.0), nav_at(-44.0, -0.8))
    assert throttle_of(astern) == pytest.approx(-throttle_for(allowed_m_s(4.0), 0.8), abs=2e-3)


def test_by_hand_a_boat_that_coasts_toward_the_line_is_braked_astern() -> None:
    allowed = allowed_m_s(4.0)
    braked = limited(Drive(0.0, 0.0), nav_at(44.0, 1.2))
    assert throttle_of(braked) == pytest.approx(throttle_for(allowed, 1.2), abs=2e-3)
    assert throttle_of(limited(Drive(1.0, 0.0), nav_at(44.0, 2.5))) == -1.0


def test_by_hand_the_feed_forward_is_through_the_water() -> None:
    allowed = allowed_m_s(10.0 - 0.4)
    braked = limited(Drive(1.0, 0.0), nav_at(38.0, 1.6, current=(0.2, 0.0)))
    assert throttle_of(braked) == pytest.approx(0.3 * (allowed - 0.2) + 2.0 * (allowed - 1.6), abs=2e-3)


# A boat that has been stopped keeps station


NORTH = HoldCourse(0.0, 2.0)


class Stopped:
    """A boat that lies 3 m before the line, where less than steerage way is allowed."""

    def __init__(self) -> None:
        self.texts: list[StatusText] = []
        self.brake = FenceBrake(self.texts)
        self.fence = laid(square(50.0))

    def look(self, count: int, intent: Intent = NORTH, nav: NavState | None = None) -> Intent:
        """Tenths of a second. Returns what is sailed."""
        for _ in range(count):
            self.brake.hold(intent)
            self.brake.limit(NORTHWARD, intent, nav or nav_at(47.0), self.fence, CONFIG, 0.1)
        return self.brake.hold(intent)


def test_after_half_a_second_it_keeps_station_inside_and_says_so_once() -> None:
    boat = Stopped()
    assert boat.look(4) is NORTH
    assert boat.texts == []
    station = boat.look(2)
    assert isinstance(station, KeepStation)
    assert station.point == pytest.approx((50.0 - 2.0 - 1.5, 0.0), abs=0.01)
    boat.look(20)
    assert [(one.severity, one.text[:12]) for one in boat.texts] == [(Severity.WARNING, "Fence ahead:")]


def test_another_intent_ends_the_station_and_the_wait() -> None:
    boat, other = Stopped(), HoldCourse(0.1, 2.0)
    boat.look(6)
    assert boat.brake.hold(HoldCourse(0.0, 2.0)) != NORTH, "the same intent, made anew"
    assert boat.brake.hold(other) is other
    assert boat.look(4) is NORTH
    assert isinstance(boat.look(2), KeepStation)


@pytest.mark.parametrize("nav", [nav_at(45.6), nav_at(0.0), replace(nav_at(47.0), position_age_s=10.0)])
def test_a_wait_that_is_interrupted_out_of_reach_or_without_a_position_begins_anew(nav: NavState) -> None:
    boat = Stopped()
    boat.look(4)
    boat.look(1, nav=nav)
    assert boat.look(4) is NORTH
    assert isinstance(boat.look(2), KeepStation)


@pytest.mark.parametrize(
    ("intent", "is_kept"),
    [
        (HoldCourse(0.0, 1.0), True),
        (HoldCourse(0.5 * math.pi, 1.0), False),
        (FollowLeg(Point(0.0, 0.0), Point(60.0, 0.0), 1.0), True),
        (FollowLeg(Point(0.0, 0.0), Point(49.0, 0.0), 1.0), False),
        (KeepStation(Point(60.0, 0.0)), False),
        (Stop(), False),
    ],
)
def test_only_what_leads_over_the_line_is_ended(intent: Intent, is_kept: bool) -> None:
    assert isinstance(Stopped().look(20, intent), KeepStation) is (is_kept or isinstance(intent, KeepStation))


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("heading_deg", "aside_m_s"), [(60.0, 0.0), (30.0, 0.5), (45.0, -0.3)])
def test_the_way_ahead_is_through_the_water_and_with_the_current_across_it(
    side: float, heading_deg: float, aside_m_s: float
) -> None:
    # 2 m/s along the bow and the current to starboard of it; the line is 6 m north; it still makes way south
    heading, drift = math.radians(heading_deg), math.atan2(aside_m_s, 2.0)
    current = (-aside_m_s * math.sin(heading), side * aside_m_s * math.cos(heading))
    braked = limited(Demand(side * heading, 2.0), nav_at(44.0, -2.0, heading=side * heading, current=current))
    carried_m = 2.0 * abs(aside_m_s * math.sin(drift))
    room_left_m = 6.0 / math.cos(heading + drift) - 2.0 - carried_m
    assert speed_of(braked) == pytest.approx(allowed_m_s(room_left_m), abs=2e-3)


def test_a_course_made_good_counts_from_a_tenth_of_a_metre_a_second() -> None:
    # 0.16 m/s along the demanded heading, made good north-east, where the line is 1.5 √2 m away
    heading = math.radians(100.0)
    braked = limited(Demand(heading, 1.0), nav_at(48.5, 0.2, east_m_s=0.2, heading=heading))
    assert speed_of(braked) == pytest.approx(allowed_m_s(1.5 * math.sqrt(2.0) - 2.0), abs=2e-3)


@pytest.mark.parametrize(("room_m", "is_braked"), [(4.7, False), (4.5, True)])
def test_at_rest_the_brake_begins_where_half_a_metre_a_second_more_could_just_be_lost(
    room_m: float, is_braked: bool
) -> None:
    # 2 m and 2 s at 0.5 m/s, and twice the 0.5 m and 0.3125 m of reaction and braking: 4.625 m
    braked = limited(NORTHWARD, nav_at(50.0 - room_m))
    assert speed_of(braked) == pytest.approx(allowed_m_s(room_m - 2.0) if is_braked else 2.0, abs=1e-3)


RUDDER = decode_config(
    {"drive": {"layout": "rudder", "turn_radius_m": 3.0}}, "test"
)  # cannot turn on the spot


@pytest.mark.parametrize("course", [0.5 * math.pi, math.pi])
@pytest.mark.parametrize(
    ("room_left_m", "off_rad", "expected"),
    [
        (5.0, math.pi, allowed_m_s(2.0)),  # a turn by a quarter circle or more takes up the radius ahead,
        (5.0, math.pi / 3.0, allowed_m_s(3.5)),  # one by 60 degrees half of it
        (5.0, 0.5, 0.4),  # a small error is no turn
        (2.5, math.pi, -0.2),  # without the room it goes astern, 0.4 of what is missing a second
        (1.0, math.pi, -0.4),
    ],
)
def test_a_boat_that_cannot_turn_on_the_spot_keeps_room_ahead_for_its_turn(
    room_left_m: float, off_rad: float, expected: float, course: float
) -> None:
    way_m = 48.0 - room_left_m
    nav = nav_at(way_m * math.cos(course), east_m=way_m * math.sin(course), heading=course)
    demand = Demand(course + off_rad, min(expected + 1.0, 2.0) if expected > 0.4 else 0.4)
    assert speed_of(limited(demand, nav, config=RUDDER)) == pytest.approx(expected)
    away = Demand(course + math.pi, 0.4)
    assert limited(away, nav) == away  # two motors turn on the spot


@pytest.mark.parametrize(
    ("ahead_m", "astern_m", "is_kept"),
    [
        (3.0, 3.0, True),  # neither room ahead for the turn nor astern for steerage way
        (5.5, 3.0, False),  # 0.17 m/s ahead
        (3.0, 9.0, False),  # astern it turns on
    ],
)
def test_a_boat_without_room_for_its_turn_keeps_station(
    ahead_m: float, astern_m: float, is_kept: bool
) -> None:
    """The demanded course along the channel is free; what is sailed leads over its line."""
    fence = laid(area(box(-astern_m, -90.0, ahead_m, 90.0)))
    brake = FenceBrake([])
    for _ in range(6):
        brake.limit(Demand(0.5 * math.pi, 0.4), NORTH, nav_at(0.0), fence, RUDDER, 0.1)
    assert isinstance(brake.hold(NORTH), KeepStation) is is_kept


def test_against_a_line_with_no_room_either_way_it_drives_on() -> None:
    """The shore may hold it: a boat that tries shows that. The demanded course along the channel is free."""

    def channel(half_m: float) -> Fence:
        return laid(area(box(-half_m, -90.0, half_m, 90.0)))

    along = Demand(0.5 * math.pi, 0.4)
    assert limited(along, nav_at(0.0), config=RUDDER, fence=channel(1.1)) == along
    assert speed_of(limited(along, nav_at(0.0), config=RUDDER, fence=channel(1.5))) == pytest.approx(0.0)
