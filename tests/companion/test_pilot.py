"""The pilot: which demand each intent leads to."""

import math

import pytest
from msgspec.structs import replace

from companion.config import BoatConfig
from companion.geo import Point
from companion.guidance.pilot import Pilot
from companion.state import Demand, NavState
from companion.vehicle.intent import Drive, FollowLeg, KeepStation, Stop

CONFIG = BoatConfig()
DT = 0.02
NORTHBOUND = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 2.0, 0.0, 0.1, 0.02)
LEG = FollowLeg(Point(0.0, 0.0), Point(100.0, 0.0), 2.0)
CORNER = FollowLeg(LEG.start, LEG.end, LEG.speed_m_s, Point(100.0, 50.0))


def _demand(pilot: Pilot, intent: FollowLeg | KeepStation, nav: NavState) -> Demand:
    demand = pilot.update(intent, nav, CONFIG, DT)
    assert isinstance(demand, Demand)
    return demand


@pytest.mark.parametrize("intent", [Stop(), Drive(0.3, -0.1)])
@pytest.mark.parametrize("nav", [None, NORTHBOUND])
def test_stop_and_drive_go_through(intent: Stop | Drive, nav: NavState | None) -> None:
    assert Pilot().update(intent, nav, CONFIG, DT) == intent


@pytest.mark.parametrize("intent", [LEG, KeepStation(Point(0.0, 0.0))])
def test_without_an_estimate_the_boat_stops(intent: FollowLeg | KeepStation) -> None:
    assert Pilot().update(intent, None, CONFIG, DT) == Stop()


def test_on_the_leg_it_holds_course_and_speed() -> None:
    assert _demand(Pilot(), LEG, NORTHBOUND) == Demand(0.0, 2.0, 0.0, 100.0)


def test_beside_the_leg_it_steers_back_and_says_how_far_off_it_is() -> None:
    demand = _demand(Pilot(), LEG, replace(NORTHBOUND, east_m=3.0))
    assert demand.heading_rad == pytest.approx(-math.atan(3.0 / CONFIG.guidance.lookahead_m))
    assert demand.cross_track_m == pytest.approx(3.0)
    assert _demand(Pilot(), LEG, replace(NORTHBOUND, east_m=-3.0)).heading_rad == -demand.heading_rad


def test_it_slows_for_the_end_and_not_for_a_straight_junction() -> None:
    near = replace(NORTHBOUND, north_m=98.0)
    assert _demand(Pilot(), LEG, near).speed_m_s < 1.0
    assert _demand(Pilot(), FollowLeg(LEG.start, LEG.end, 2.0, Point(200.0, 0.0)), near).speed_m_s == 2.0


def test_it_turns_onto_the_next_leg_before_the_corner() -> None:
    assert _demand(Pilot(), CORNER, replace(NORTHBOUND, north_m=90.0)).heading_rad == pytest.approx(0.0)
    early = _demand(Pilot(), CORNER, replace(NORTHBOUND, north_m=98.0))
    assert 0.2 < early.heading_rad < math.pi / 2
    assert early.cross_track_m == pytest.approx(0.0)  # still told of the leg it is on


def test_it_turns_with_the_arc_and_says_how_fast() -> None:
    pilot = Pilot()
    assert _demand(pilot, CORNER, replace(NORTHBOUND, north_m=80.0)).yaw_rate_rad_s == 0.0
    slow = replace(NORTHBOUND, north_m=98.5, north_m_s=0.6, surge_m_s=0.6)
    demand = _demand(pilot, CORNER, slow)
    assert demand.yaw_rate_rad_s == pytest.approx(0.6 / CONFIG.guidance.corner_radius_m)
    assert demand.speed_m_s < 1.0


def test_the_arc_is_sailed_out_on_the_next_leg_and_then_forgotten() -> None:
    pilot = Pilot()
    onward = FollowLeg(LEG.end, Point(100.0, 50.0), 2.0)
    middle = replace(
        NORTHBOUND, north_m=99.56, east_m=0.44, heading_rad=math.pi / 4, north_m_s=0.4, east_m_s=0.4
    )
    _demand(pilot, CORNER, middle)
    demand = _demand(pilot, onward, middle)
    assert math.pi / 4 < demand.heading_rad < math.pi / 2
    assert demand.speed_m_s < 1.0
    beyond = replace(middle, north_m=100.0, east_m=10.0, heading_rad=math.pi / 2, north_m_s=0.0, east_m_s=0.6)
    _demand(pilot, onward, beyond)
    demand = _demand(pilot, onward, beyond)
    assert demand.heading_rad == pytest.approx(math.pi / 2)
    assert demand.speed_m_s == 2.0


def test_a_leg_that_does_not_go_on_from_the_corner_owes_it_nothing() -> None:
    pilot = Pilot()
    near = replace(NORTHBOUND, north_m=98.5)
    _demand(pilot, CORNER, near)
    elsewhere = FollowLeg(Point(98.5, 0.0), Point(200.0, 0.0), 2.0)
    assert _demand(pilot, elsewhere, near) == Demand(0.0, 2.0, 0.0, 101.5)


def test_a_bow_that_points_elsewhere_turns_on_the_spot() -> None:
    assert _demand(Pilot(), LEG, replace(NORTHBOUND, heading_rad=2.0)).speed_m_s == 0.0


def test_the_bow_is_held_against_the_set() -> None:
    in_a_current = replace(NORTHBOUND, set_east_m_s=0.5)
    demand = _demand(Pilot(), LEG, in_a_current)
    assert demand.heading_rad == pytest.approx(-math.atan(0.5 / 2.0))
    # Along the bow, over ground: what it takes through the water, and the set's part of it.
    assert demand.speed_m_s == pytest.approx(math.hypot(2.0, 0.5))


def test_the_arc_is_laid_wider_once_a_set_from_astern_is_known() -> None:
    pilot = Pilot()
    far = replace(NORTHBOUND, north_m=40.0)
    _demand(pilot, CORNER, far)
    at = replace(NORTHBOUND, north_m=97.3, north_m_s=1.0, surge_m_s=1.0, set_north_m_s=0.5)
    assert _demand(pilot, CORNER, replace(at, set_north_m_s=0.0)).yaw_rate_rad_s == 0.0
    _demand(pilot, CORNER, replace(far, set_north_m_s=0.5))
    assert _demand(pilot, CORNER, at).yaw_rate_rad_s > 0.0


def test_a_new_station_forgets_the_old_ones_line() -> None:
    pilot = Pilot()
    here = Point(0.0, 0.0)
    still = NavState(0.0, 0.0, 0.0, 0.7, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02)
    assert _demand(pilot, KeepStation(here), still).heading_rad == pytest.approx(0.7)
    turned = replace(still, heading_rad=-1.0)
    assert _demand(pilot, KeepStation(here), turned).heading_rad == pytest.approx(0.7)
    nearly_the_same = KeepStation(Point(0.1, 0.0))
    assert _demand(pilot, nearly_the_same, turned).heading_rad == pytest.approx(0.7)
    there = replace(turned, north_m=5.0)
    assert _demand(pilot, KeepStation(Point(5.0, 0.0)), there).heading_rad == pytest.approx(-1.0)
    pilot.update(Stop(), turned, CONFIG, DT)
    assert _demand(pilot, KeepStation(here), turned).heading_rad == pytest.approx(-1.0)


def test_a_leg_without_length_is_sailed_straight_to_its_end() -> None:
    end = Point(10.0, 10.0)
    resting = replace(NORTHBOUND, north_m_s=0.0, surge_m_s=0.0)
    demand = _demand(Pilot(), FollowLeg(end, end, 2.0), resting)
    assert demand.heading_rad == pytest.approx(math.pi / 4)
    assert demand.distance_m == pytest.approx(math.hypot(10.0, 10.0))


def test_a_set_from_astern_turns_the_boat_about_before_its_stop() -> None:
    carried = replace(NORTHBOUND, set_north_m_s=1.0)
    assert _demand(Pilot(), LEG, replace(carried, north_m=80.0)).heading_rad == pytest.approx(0.0)
    early = _demand(Pilot(), LEG, replace(carried, north_m=92.0))
    assert early.speed_m_s < 2.0
    near = _demand(Pilot(), LEG, replace(carried, north_m=96.0))
    assert abs(near.heading_rad) == pytest.approx(math.pi)
    assert _demand(Pilot(), CORNER, replace(carried, north_m=96.0)).heading_rad < 2.0
