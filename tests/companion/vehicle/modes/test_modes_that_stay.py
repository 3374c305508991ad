"""The modes by hand and those that stay, each alone: what it does as it begins, and its intent."""

import math

import pytest
from boat_rig import nav_at, place
from mode_inputs import around, fenced, held, mode_inputs, turned
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, with_value
from companion.core import intent as intents
from companion.core.geo import Point
from companion.core.requests import OtherVehicle, SetPoint
from companion.core.state import NavState
from companion.core.status_text import StatusText
from companion.geofence.fence import Fence
from companion.rc.manual_input import top_speed_m_s
from companion.vehicle.modes.by_hand import ManualMode, SimpleMode, SteeringMode
from companion.vehicle.modes.follow import FollowMode
from companion.vehicle.modes.guided import GuidedMode
from companion.vehicle.modes.loiter import LoiterMode

CONFIG = BoatConfig()
TOP_M_S = top_speed_m_s(CONFIG.speed)


def without_position(north_m_s: float = 0.0, east_m_s: float = 0.0) -> NavState:
    return replace(
        nav_at(),
        position_age_s=100.0,
        current_north_m_s=north_m_s,
        current_east_m_s=east_m_s,
        heading_rad=1.0,
    )


def without_heading(east_m_s: float) -> NavState:
    return replace(nav_at(), heading_age_s=100.0, current_east_m_s=east_m_s)


def local(intent: intents.Intent) -> Point:
    assert isinstance(intent, intents.KeepStation)
    return intent.point


# By hand


def test_manual_passes_the_sticks_on() -> None:
    assert ManualMode(held(0.5, -0.25)).intent(mode_inputs()) == intents.Drive(0.5, -0.25)
    assert ManualMode(held(0.5, -0.25)).drive(CONFIG, 0.0) == intents.Drive(0.5, -0.25)


def test_steering_asks_for_a_lateral_acceleration() -> None:
    accel = CONFIG.guidance.corner_accel_m_s2
    fast = SteeringMode(held(1.0, 0.5)).intent(mode_inputs())
    assert isinstance(fast, intents.HoldTurn)
    assert fast.speed_m_s == pytest.approx(TOP_M_S)
    assert fast.yaw_rate_rad_s * TOP_M_S == pytest.approx(0.5 * accel)


def test_steering_never_turns_faster_than_acro() -> None:
    config = with_value(CONFIG, "guidance.corner_accel_m_s2", 100.0)
    slow = SteeringMode(held(0.0, -1.0)).intent(mode_inputs(config=config))
    assert slow == intents.HoldTurn(-CONFIG.modes.turn_rate_rad_s, 0.0)


def test_simple_goes_where_the_stick_points_as_seen_at_entry() -> None:
    mode = SimpleMode(held(0.0, 0.6))
    mode.enter(mode_inputs(turned(1.0)))
    intent = mode.intent(mode_inputs(turned(2.0)))
    assert isinstance(intent, intents.HoldHeading)
    assert intent.heading_rad == pytest.approx(1.0 + math.pi / 2.0)
    assert intent.speed_m_s == pytest.approx(0.6 * TOP_M_S)


def test_simple_holds_its_heading_while_the_stick_is_centred() -> None:
    mode = SimpleMode(held(0.03, 0.03))
    mode.enter(mode_inputs(turned(1.0)))
    assert mode.intent(mode_inputs(turned(2.0))) == intents.HoldHeading(1.0, 0.0)


# That stay


def test_loiter_stays_where_it_begins() -> None:
    mode = LoiterMode(Fence())
    mode.enter(mode_inputs(nav_at(3.0, 4.0)))
    assert local(mode.intent(mode_inputs(nav_at(30.0, 4.0)))) == pytest.approx((3.0, 4.0), abs=1e-3)
    assert mode.needs_position
    assert mode.destination is not None


def test_loiter_comes_back_inside_the_fence() -> None:
    mode = LoiterMode(fenced(50.0))
    mode.enter(mode_inputs(nav_at(60.0, 0.0)))
    inside_m = 50.0 - CONFIG.fence.margin_m - CONFIG.guidance.station_radius_m
    assert local(mode.intent(mode_inputs(nav_at(60.0, 0.0)))) == pytest.approx((inside_m, 0.0), abs=0.2)


def test_loiter_without_a_position_holds_into_the_current() -> None:
    mode = LoiterMode(Fence())
    mode.enter(mode_inputs())
    into = mode.intent(mode_inputs(without_position(north_m_s=0.3)))
    assert isinstance(into, intents.HoldHeading)
    assert (abs(into.heading_rad), into.speed_m_s) == pytest.approx((math.pi, 0.0))
    assert not mode.needs_position
    assert mode.intent(mode_inputs(without_position(east_m_s=0.3))) == into  # held, not chased
    mode.exit()
    assert mode.needs_position


def test_loiter_searches_its_heading_by_turns_in_a_current() -> None:
    mode = LoiterMode(Fence())
    mode.enter(mode_inputs())
    ahead = [
        isinstance(mode.intent(mode_inputs(without_heading(0.5), now_s=0.5 + now_s)), intents.Drive)
        for now_s in range(20)
    ]
    assert ahead == [True] * 6 + [False] * 10 + [True] * 4


def test_loiter_without_a_heading_drifts_in_a_slow_current() -> None:
    mode = LoiterMode(Fence())
    mode.enter(mode_inputs())
    assert mode.intent(mode_inputs(without_heading(0.25))) == intents.Stop()


def test_guided_sails_to_its_target_then_stays_there() -> None:
    texts: list[StatusText] = []
    mode = GuidedMode(around(Fence()), texts)
    mode.enter(mode_inputs())
    mode.go_to(place(20.0, 0.0))
    leg = mode.intent(mode_inputs())
    assert isinstance(leg, intents.FollowLeg)
    assert mode.destination == place(20.0, 0.0)
    stays = mode.intent(mode_inputs(nav_at(20.0, 0.0)))
    assert local(stays) == pytest.approx((20.0, 0.0), abs=1e-3)
    assert mode.target is None
    assert mode.destination == place(20.0, 0.0)
    assert [one.text for one in texts] == ["GUIDED: arrived"]


def test_follow_stays_where_it_loses_its_lead() -> None:
    texts: list[StatusText] = []
    mode = FollowMode(texts)
    mode.ingest(OtherVehicle(2, place(20.0, 0.0), 1.0, 0.0, 0.0), CONFIG.follow, 0.0)
    mode.enter(mode_inputs())
    assert isinstance(mode.intent(mode_inputs()), intents.HoldCourse)
    for now_s in (10.0, 11.0):
        stays = mode.intent(mode_inputs(nav_at(now_s, 0.0), now_s=now_s))
        assert local(stays) == pytest.approx((10.0, 0.0), abs=1e-3)
    assert [one.text for one in texts] == ["FOLLOW: no vehicle is heard, keeping station"]


def test_simple_moves_from_a_small_push_on() -> None:
    mode = SimpleMode(held(0.06, 0.0))
    mode.enter(None)
    intent = mode.intent(mode_inputs(turned(2.0)))
    assert intent == intents.HoldHeading(0.0, 0.06 * TOP_M_S)


def test_a_stale_set_point_is_reported_once_and_leaves_no_target() -> None:
    texts: list[StatusText] = []
    mode = GuidedMode(around(Fence()), texts)
    mode.enter(mode_inputs())
    mode.go_to(place(50.0, 0.0))
    mode.hold(SetPoint(intents.HoldCourse(1.0, 2.0)), 0.0)
    stale_s = CONFIG.modes.set_point_timeout_s + 0.1
    mode.intent(mode_inputs(nav_at(9.0, 0.0), now_s=stale_s))
    stays = mode.intent(mode_inputs(nav_at(12.0, 0.0), now_s=stale_s + 1.0))
    assert local(stays) == pytest.approx((9.0, 0.0), abs=1e-3)
    assert len(texts) == 1
