"""A leg that something seen bars: left, rounded, and sailed on where it is free again."""

import math

import pytest
from boat_rig import nav_at
from laid_fence import laid
from mode_inputs import around

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import FollowLeg
from companion.vehicle.leg_passage import LegPassage

CONFIG = BoatConfig()
SIGHT_M, LOOKAHEAD_M = CONFIG.avoidance.lookahead_m, CONFIG.guidance.lookahead_m
WANTED = FollowLeg(Point(0.0, 0.0), Point(100.0, 0.0), 1.5)


class Leg:
    """A hundred metres north."""

    def __init__(self) -> None:
        self.surroundings = around(laid())
        self.surroundings.prepare(CONFIG.fence.margin_m)
        self.legs = LegPassage(self.surroundings)
        self.now_s = 0.0

    def see_wall(self, north_m: int, west_m: int = -12, east_m: int = 12) -> None:
        """Across the leg, a cell a metre."""
        for cell in range(west_m, east_m):
            self.surroundings.voyage._add((north_m, cell), Point(north_m + 0.5, cell + 0.5))

    def is_led(self) -> bool:
        return self.legs.is_led

    def is_shut(self) -> bool:
        return self.legs.is_shut

    def sail(self, north_m: float, east_m: float = 0.0, wanted: FollowLeg = WANTED) -> FollowLeg:
        """What is sailed from a place, once everything is searched."""
        self.now_s += 1.0
        for _ in range(100):
            sailed = self.legs.update(wanted, nav_at(north_m, east_m), CONFIG, self.now_s)
        return sailed


def test_a_leg_is_kept_until_what_bars_it_is_in_sight() -> None:
    leg = Leg()
    leg.see_wall(50)
    assert leg.sail(20.0) is WANTED
    assert leg.sail(49.0 - LOOKAHEAD_M - SIGHT_M) is WANTED
    assert leg.sail(50.5 - LOOKAHEAD_M - SIGHT_M) is not WANTED
    assert leg.is_led()
    assert abs(leg.sail(44.0).end.east_m) > 12.0
    assert leg.legs.way is not None
    assert leg.legs.way.left_m(Point(44.0, 0.0)) > 60.0


def test_the_line_itself_is_sailed_on_where_it_is_met_beyond_the_wall() -> None:
    leg = Leg()
    leg.see_wall(50)
    leg.sail(44.0)
    assert leg.is_led()
    assert leg.sail(50.5, 11.0).end != WANTED.end, "still beside it"
    assert leg.is_led()
    sailed = leg.sail(51.0, 14.0)
    assert not leg.is_led()
    assert (sailed.start, sailed.next_end, sailed.speed_m_s) == (WANTED.start, WANTED.end, 1.5)
    assert sailed.end == pytest.approx((51.0 + 14.0 + LOOKAHEAD_M, 0.0), abs=0.6)
    assert leg.sail(58.0, 7.0).end == sailed.end, "where it is to be met stays"
    assert leg.sail(62.0, 1.6).end == sailed.end
    assert leg.sail(63.0, 1.4) is WANTED


def test_a_boat_far_off_its_line_where_nothing_was_seen_sails_its_leg() -> None:
    assert Leg().sail(50.0, 14.0) is WANTED


def test_what_is_rounded_within_a_sight_is_left_to_the_local_planner() -> None:
    leg = Leg()
    leg.see_wall(50, -1, 2)
    assert leg.sail(44.0) is WANTED
    assert not leg.is_led()


def test_another_leg_begins_free() -> None:
    leg = Leg()
    leg.see_wall(50)
    leg.sail(44.0)
    other = FollowLeg(Point(44.0, 0.0), Point(0.0, 0.0), 1.5)
    assert leg.sail(44.0, wanted=other) is other
    assert leg.legs.way is None


def test_only_what_is_shut_in_all_round_is_out_of_reach() -> None:
    leg = Leg()
    for degrees in range(0, 300):
        at = Point(60.0 + 12.0 * math.cos(math.radians(degrees)), 12.0 * math.sin(math.radians(degrees)))
        leg.surroundings.voyage._add((math.floor(at.north_m), math.floor(at.east_m)), at)
    wanted = FollowLeg(WANTED.start, Point(60.0, 0.0), 1.5)
    leg.sail(42.0, wanted=wanted)
    assert leg.is_led()
    assert not leg.is_shut()
    for degrees in range(300, 360):
        at = Point(60.0 + 12.0 * math.cos(math.radians(degrees)), 12.0 * math.sin(math.radians(degrees)))
        leg.surroundings.voyage._add((math.floor(at.north_m), math.floor(at.east_m)), at)
    leg.sail(42.0, wanted=wanted)
    assert leg.is_shut()
    leg.legs.sail_on()
    assert not leg.is_shut()
