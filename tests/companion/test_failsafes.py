import pytest
from boat_rig import FRAME, GOOD_FIX, nav_at

from companion.config import BoatConfig, Failsafe, with_value
from companion.requests import Arm, ChangeMode
from companion.sensors.readings import BatteryReading
from companion.vehicle.failsafe import Action, Alarm, BatteryWatch, OperatorWatch
from companion.vehicle.modes import Mode
from companion.vehicle.vehicle import Vehicle

SETTING = Failsafe(gcs_timeout_s=5.0, battery_low_v=10.2, battery_low_s=10.0)


def operator_alarms(heard_s: list[float], until_s: int, setting: Failsafe = SETTING) -> list[int]:
    """The whole seconds at which the watch fires."""
    watch = OperatorWatch()
    fired = []
    for now_s in range(until_s):
        if now_s in heard_s:
            watch.heard(now_s)
        if watch.update(setting, now_s) is not None:
            fired.append(now_s)
    return fired


def test_an_operator_who_was_never_heard_is_never_missed() -> None:
    assert operator_alarms([], 1000) == []


def test_silence_fires_once_and_again_only_after_the_operator_came_back() -> None:
    assert operator_alarms([0, 1, 2], 60) == [8]
    assert operator_alarms([0, 20], 60) == [6, 26]
    assert operator_alarms([0], 60, Failsafe(gcs_enabled=False)) == []


def battery_alarms(volts: list[float], setting: Failsafe = SETTING) -> list[int]:
    watch = BatteryWatch()
    return [
        now_s
        for now_s, volt in enumerate(volts)
        if watch.update(setting, BatteryReading(now_s, volt), now_s) is not None
    ]


def test_a_low_pack_fires_once_after_its_time() -> None:
    assert battery_alarms([12.0, *[10.1] * 30]) == [11]


def test_a_sag_under_load_is_forgiven() -> None:
    assert battery_alarms([*[10.1] * 9, 10.3, *[10.1] * 9, 10.3]) == []


def test_no_limit_and_no_monitor_never_fire() -> None:
    assert battery_alarms([1.0] * 60, Failsafe(battery_low_v=0.0)) == []
    assert BatteryWatch().update(SETTING, None, 100.0) is None


def test_the_alarm_says_what_and_how_much() -> None:
    watch = BatteryWatch()
    watch.update(SETTING, BatteryReading(0.0, 9.87), 0.0)
    assert watch.update(SETTING, BatteryReading(10.0, 9.87), 10.0) == Alarm(Action.RTL, "Battery low: 9.9 V")


def armed_vehicle(mode: Mode, action: Action) -> Vehicle:
    config = with_value(BoatConfig(), "failsafe.action", int(action))
    vehicle = Vehicle(config)
    vehicle.sense(nav_at(), FRAME, GOOD_FIX, None, 0.0)
    assert vehicle.request(ChangeMode(mode)).accepted
    assert vehicle.request(Arm()).accepted
    return vehicle


def lose_operator(vehicle: Vehicle) -> list[str]:
    vehicle.operator.heard(0.0)
    vehicle.take_notices()
    for now_s in range(10):
        vehicle.sense(nav_at(time_s=now_s), vehicle.frame, GOOD_FIX, None, now_s)
        vehicle.decide()
    return [notice.text for notice in vehicle.take_notices()]


@pytest.mark.parametrize(
    ("action", "mode"),
    [
        (Action.NONE, Mode.GUIDED),
        (Action.RTL, Mode.RTL),
        (Action.HOLD, Mode.HOLD),
        (Action.SMART_RTL_OR_RTL, Mode.SMART_RTL),
        (Action.SMART_RTL_OR_HOLD, Mode.SMART_RTL),
        (Action.LOITER_OR_HOLD, Mode.LOITER),
    ],
)
def test_each_action_puts_the_boat_into_its_mode(action: Action, mode: Mode) -> None:
    vehicle = armed_vehicle(Mode.GUIDED, action)
    texts = lose_operator(vehicle)
    assert texts[0] == "Failsafe: Operator lost for 5 s"
    assert (vehicle.mode, vehicle.armed) == (mode, True)


@pytest.mark.parametrize(
    ("action", "mode"), [(Action.SMART_RTL_OR_RTL, Mode.RTL), (Action.SMART_RTL_OR_HOLD, Mode.HOLD)]
)
def test_a_boat_that_does_not_know_its_track_takes_the_second_choice(action: Action, mode: Mode) -> None:
    vehicle = armed_vehicle(Mode.GUIDED, action)
    vehicle.conduct.trail.is_lost = True
    lose_operator(vehicle)
    assert vehicle.mode is mode


@pytest.mark.parametrize("mode", [Mode.GUIDED, Mode.HOLD])
def test_the_action_disarm_disarms_in_every_mode(mode: Mode) -> None:
    vehicle = armed_vehicle(mode, Action.DISARM)
    assert "Disarmed by failsafe" in lose_operator(vehicle)
    assert not vehicle.armed


def test_a_boat_on_hold_stays_on_hold() -> None:
    vehicle = armed_vehicle(Mode.HOLD, Action.RTL)
    lose_operator(vehicle)
    assert vehicle.mode is Mode.HOLD


def test_a_boat_on_its_way_home_is_not_told_to_loiter() -> None:
    vehicle = armed_vehicle(Mode.RTL, Action.LOITER_OR_HOLD)
    lose_operator(vehicle)
    assert vehicle.mode is Mode.RTL


def test_a_boat_without_position_holds_where_it_was_told_to_loiter() -> None:
    vehicle = armed_vehicle(Mode.MANUAL, Action.LOITER_OR_HOLD)
    vehicle.frame = None
    lose_operator(vehicle)
    assert vehicle.mode is Mode.HOLD


def test_after_a_failsafe_the_operator_is_free_to_choose_another_mode() -> None:
    vehicle = armed_vehicle(Mode.GUIDED, Action.HOLD)
    lose_operator(vehicle)
    vehicle.operator.heard(10.0)
    assert vehicle.request(ChangeMode(Mode.GUIDED)).accepted
    vehicle.decide()
    assert vehicle.mode is Mode.GUIDED


def test_a_disarmed_boat_stays_in_its_mode() -> None:
    vehicle = armed_vehicle(Mode.GUIDED, Action.RTL)
    vehicle.armed = False
    assert lose_operator(vehicle)[0].startswith("Failsafe")
    assert vehicle.mode is Mode.GUIDED
