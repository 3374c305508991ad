import math

import pytest
from boat_rig import FRAME, GOOD_FIX, nav_at, place
from msgspec.structs import replace

from companion.config.actuators import DriveSetting
from companion.config.boat_config import BoatConfig
from companion.core import requests
from companion.core.intent import FollowLeg, HoldCourse, KeepStation, Stop
from companion.core.modes import Mode, mode_from_number
from companion.core.readings import BatteryReading
from companion.core.state import NavState
from companion.core.status_text import Severity
from companion.failsafe import actions
from companion.failsafe.actions import Trigger
from companion.failsafe.inputs import BoardReadings
from companion.geofence.fence import FenceCircle
from companion.vehicle.failsafes import _carry_out as carry_out
from companion.vehicle.mission.steps import Home, Mission, MoveHome, Waypoint
from companion.vehicle.vehicle import Vehicle

MISSION: Mission = (Home(), Waypoint(place(50.0, 0.0)), Waypoint(place(50.0, 50.0)))


def vehicle_at(north_m: float = 0.0, east_m: float = 0.0, mode: Mode | None = None) -> Vehicle:
    """A vehicle that knows where it is; armed when a mode is given."""
    vehicle = Vehicle(BoatConfig())
    tick(vehicle, nav_at(north_m, east_m), 0.0)
    if mode is not None:
        assert vehicle.request(requests.ChangeMode(mode)).accepted
        assert vehicle.request(requests.Arm()).accepted
    vehicle.take_status_texts()
    return vehicle


def tick(vehicle: Vehicle, nav: NavState, now_s: float) -> object:
    vehicle.update_state(nav, FRAME, GOOD_FIX, None, now_s)
    return vehicle.decide()


def texts(vehicle: Vehicle) -> list[str]:
    return [notice.text for notice in vehicle.take_status_texts()]


@pytest.mark.parametrize("number", [2, 13, 14, 16, -1, 2**31])
def test_a_mode_that_this_boat_does_not_have_is_refused_and_not_pretended(number: int) -> None:
    assert mode_from_number(number) is None
    vehicle = vehicle_at()
    outcome = vehicle.request(requests.ChangeMode(number))
    assert not outcome.accepted
    assert texts(vehicle) == [f"Mode {number} is not available on this boat"]
    assert vehicle.mode is Mode.HOLD


@pytest.mark.parametrize("mode", list(Mode))
def test_a_disarmed_boat_gives_no_thrust_in_any_mode(mode: Mode) -> None:
    vehicle = vehicle_at()
    vehicle.set_mission(MISSION)
    vehicle.request(requests.Arm())
    vehicle.request(requests.Disarm())
    vehicle.request(requests.OtherVehicle(2, place(20.0, 0.0), 1.0, 0.0, 0.0))
    assert vehicle.request(requests.ChangeMode(mode)).accepted
    vehicle.request(requests.ManualControl(1.0, 0.0))
    assert tick(vehicle, nav_at(), 0.02) == Stop()


def test_a_go_to_outside_guided_needs_leave_to_change_the_mode() -> None:
    vehicle = vehicle_at(mode=Mode.LOITER)
    assert vehicle.request(requests.GoTo(place(20.0, 0.0))).reason == "Go to: not in GUIDED"
    assert vehicle.request(requests.GoTo(place(20.0, 0.0), change_mode=True)).accepted
    assert vehicle.request(requests.ChangeMode(Mode.LOITER)).accepted
    assert vehicle.modes.guided.target is None, "the mode has ended"


def test_nothing_outside_the_fence_is_sailed_to() -> None:
    vehicle = vehicle_at(mode=Mode.GUIDED)
    vehicle.set_fence([FenceCircle(place(0.0, 0.0), 60.0, is_inclusion=True)])
    assert vehicle.request(requests.GoTo(place(61.0, 0.0))).reason == "Go to: outside the fence"
    assert vehicle.request(requests.GoTo(place(59.0, 0.0))).accepted
    vehicle.set_mission(MISSION)
    tick(vehicle, nav_at(), 0.1)
    fault = "item 2 is outside the fence"
    assert vehicle.request(requests.ChangeMode(Mode.AUTO)).reason == f"AUTO: {fault}"
    assert f"Mission: {fault}" in texts(vehicle)


def test_a_target_from_before_arming_is_forgotten() -> None:
    vehicle = vehicle_at()
    vehicle.request(requests.GoTo(place(20.0, 0.0), change_mode=True))
    vehicle.request(requests.Arm())
    assert isinstance(tick(vehicle, nav_at(), 1.0), KeepStation)


def test_home_that_was_chosen_is_not_moved_by_arming() -> None:
    vehicle = vehicle_at(5.0, 5.0)
    assert vehicle.request(requests.SetHome(place(-10.0, 0.0))).accepted
    vehicle.request(requests.Arm())
    assert vehicle.home == place(-10.0, 0.0)
    vehicle.request(requests.SetHome())
    assert vehicle.home is not None
    assert FRAME.to_local(vehicle.home) == pytest.approx((5.0, 5.0), abs=1e-3)


def test_home_cannot_be_here_before_here_is_known() -> None:
    assert Vehicle(BoatConfig()).request(requests.SetHome()).reason == "Home: no position yet"


def test_a_refused_arming_says_every_reason() -> None:
    vehicle = Vehicle(BoatConfig())
    outcome = vehicle.request(requests.Arm())
    assert outcome.reason == "Compass: no heading"
    assert texts(vehicle) == ["Arm: Compass: no heading"]
    assert vehicle.request(requests.Arm(force=True)).accepted
    assert vehicle.armed


def test_disarming_says_by_whom_and_only_once() -> None:
    vehicle = vehicle_at(mode=Mode.HOLD)
    vehicle.request(requests.Disarm("by emergency stop"))
    vehicle.request(requests.Disarm())
    assert texts(vehicle) == ["Disarmed by emergency stop"]


def test_starting_the_mission_enters_auto_at_the_item_asked_for() -> None:
    vehicle = vehicle_at(mode=Mode.HOLD)
    assert vehicle.request(requests.StartMission()).reason == "AUTO: no mission"
    vehicle.set_mission(MISSION)
    assert vehicle.request(requests.StartMission(2)).accepted
    assert (vehicle.mode, vehicle.progress.current_seq) == (Mode.AUTO, 2)
    assert vehicle.request(requests.StartMission(3)).reason == "Mission has no item 3 (last is 2)"
    assert vehicle.request(requests.SetCurrentItem(7)).reason == "Mission has no item 7 (last is 2)"
    assert vehicle.progress.current_seq == 2


@pytest.mark.parametrize(("behave", "mode"), [(0, Mode.HOLD), (1, Mode.LOITER)])
def test_after_the_mission_the_boat_does_as_it_was_told(behave: int, mode: Mode) -> None:
    vehicle = vehicle_at(mode=Mode.HOLD)
    vehicle.config = BoatConfig(mission=type(vehicle.config.mission)(done_behave=behave))
    vehicle.set_mission(MISSION)
    vehicle.request(requests.StartMission())
    tick(vehicle, nav_at(50.0, 0.0), 1.0)
    intent = tick(vehicle, nav_at(50.0, 49.0), 2.0)
    assert vehicle.mode is mode
    assert isinstance(intent, Stop if mode is Mode.HOLD else KeepStation)
    if isinstance(intent, KeepStation):
        assert intent.point == pytest.approx((50.0, 50.0), abs=1e-3)
    assert "Mission complete" in texts(vehicle)


def test_a_speed_lasts_until_the_mode_changes() -> None:
    vehicle = vehicle_at(mode=Mode.GUIDED)
    vehicle.request(requests.ChangeSpeed(0.7))
    vehicle.request(requests.GoTo(place(20.0, 0.0)))
    leg = tick(vehicle, nav_at(), 0.1)
    assert isinstance(leg, FollowLeg)
    assert leg.speed_m_s == 0.7
    vehicle.set_mission(MISSION)
    vehicle.request(requests.StartMission())
    leg = tick(vehicle, nav_at(), 0.2)
    assert isinstance(leg, FollowLeg)
    assert leg.speed_m_s == vehicle.config.speed.cruise_m_s
    vehicle.request(requests.ChangeSpeed(0.9))
    leg = tick(vehicle, nav_at(), 0.3)
    assert isinstance(leg, FollowLeg)
    assert leg.speed_m_s == 0.9


def test_a_set_point_steers_only_in_guided() -> None:
    vehicle, east = vehicle_at(mode=Mode.LOITER), HoldCourse(math.pi / 2.0, 0.7)
    point = requests.SetPoint(east)
    assert vehicle.request(point).reason == "not in GUIDED"
    vehicle.request(requests.ChangeMode(Mode.GUIDED))
    assert tick(vehicle, nav_at(), 0.1) != east
    assert vehicle.request(point).accepted
    assert tick(vehicle, nav_at(), 0.2) == east


def test_each_decision_of_the_failsafes_is_carried_out() -> None:
    vehicle = vehicle_at(mode=Mode.LOITER)
    for decision in (
        actions.Notify(Severity.NOTICE, "Notified"),
        actions.LimitSpeed(0.5),
        actions.Recover(Trigger.CHECK, Severity.NOTICE, "Checking"),
    ):
        carry_out(decision, vehicle, 1.0)
    assert texts(vehicle) == ["Notified", "Checking"]
    assert vehicle.speed_m_s == 0.5 * vehicle.config.speed.cruise_m_s
    carry_out(actions.Retreat((Mode.RTL, Mode.HOLD)), vehicle, 1.1)
    assert (vehicle.mode, vehicle.retreated_from) == (Mode.RTL, Mode.LOITER)
    carry_out(actions.StopMotors(), vehicle, 1.2)
    assert not vehicle.armed
    assert texts(vehicle)[-1] == "Disarmed by failsafe"


def test_a_boat_that_loses_its_estimate_stops() -> None:
    vehicle = vehicle_at(mode=Mode.GUIDED)
    vehicle.update_state(None, None, None, None, 2.0)
    assert vehicle.decide() == Stop()


def test_what_a_recovery_has_found_is_told_and_nothing_before() -> None:
    vehicle = vehicle_at(mode=Mode.LOITER)
    carry_out(actions.Recover(Trigger.CHECK, Severity.NOTICE, ""), vehicle, 0.0)
    for tenth in range(1, 200):
        tick(vehicle, nav_at(), 0.1 * tenth)
    assert texts(vehicle) == ["Motor check: result unclear"]


def test_a_rudder_that_turns_no_boat_is_noticed() -> None:
    vehicle = vehicle_at(mode=Mode.GUIDED)
    vehicle.config = BoatConfig(drive=DriveSetting(layout="rudder"))
    vehicle.board = BoardReadings(left=0.6, right=0.6, rudder=1.0)
    for tenth in range(1, 60):
        tick(vehicle, replace(nav_at(), north_m_s=2.0, surge_m_s=2.0), 0.1 * tenth)
    assert "Failsafe: Steering lost: rudder or motor has no effect" in texts(vehicle)


def test_the_charge_is_held_against_the_way_home_while_the_boat_sails() -> None:
    vehicle = vehicle_at(mode=Mode.GUIDED)
    vehicle.board = BoardReadings(consumed_mah=4900.0)
    nav = replace(nav_at(500.0), north_m_s=1.0, surge_m_s=1.0)
    for tenth in range(1, 380):
        vehicle.update_state(nav, FRAME, GOOD_FIX, BatteryReading(0.1 * tenth, 12.6, 5.0), 0.1 * tenth)
        vehicle.decide()
    assert any(text.startswith("Failsafe: Point of no return") for text in texts(vehicle))


def test_a_mission_moves_home() -> None:
    vehicle = vehicle_at(mode=Mode.HOLD)
    vehicle.set_mission((Home(), MoveHome(place(5.0, 6.0)), *MISSION[1:]))
    vehicle.request(requests.StartMission())
    tick(vehicle, nav_at(), 0.1)
    assert vehicle.home == place(5.0, 6.0)


def test_a_fault_of_the_program_puts_the_boat_on_hold_once_or_disarms_it() -> None:
    vehicle = vehicle_at(mode=Mode.LOITER)
    for told in (["A fault", "Mode HOLD: fault"], []):
        vehicle.stop_on_fault("A fault", disarms=False)
        assert (vehicle.mode, vehicle.armed, texts(vehicle)) == (Mode.HOLD, True, told)
    for told in (["A fault", "Disarmed by the program"], []):
        vehicle.stop_on_fault("A fault", disarms=True)
        assert (vehicle.armed, texts(vehicle)) == (False, told)


def test_the_track_is_recorded_while_the_position_is_known() -> None:
    vehicle = vehicle_at(mode=Mode.GUIDED)
    tick(vehicle, nav_at(20.0, 0.0), 0.1)
    tick(vehicle, nav_at(40.0, 0.0, age_s=10.0), 0.2)
    assert vehicle.track.latest == (20.0, 0.0)
