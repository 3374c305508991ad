import pytest
from boat_rig import FRAME, GOOD_FIX, nav_at
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, with_value
from companion.config.tuning import Failsafe
from companion.core.modes import Mode
from companion.core.readings import BatteryReading
from companion.core.requests import Arm, ChangeMode, GoTo
from companion.core.state import EstimateFault
from companion.failsafe.actions import Action
from companion.failsafe.inputs import BoardReadings
from companion.failsafe.monitor import Change, Escalation
from companion.failsafe.table import ROWS, Condition
from companion.vehicle.vehicle import Vehicle


def armed_vehicle(mode: Mode = Mode.GUIDED, **settings: object) -> Vehicle:
    """At rest at the frame's origin, with a fix; settings: of the failsafes."""
    config = BoatConfig()
    for name, value in settings.items():
        config = with_value(config, f"failsafe.{name}", value)
    vehicle = Vehicle(config)
    vehicle.update_state(nav_at(), FRAME, GOOD_FIX, None, 0.0)
    assert vehicle.request(ChangeMode(mode)).accepted
    assert vehicle.request(Arm()).accepted
    vehicle.take_status_texts()
    return vehicle


def live(
    vehicle: Vehicle,
    seconds: float,
    volt: float | None = None,
    step_s: float = 0.5,
    yaw_rate_rad_s: float = 0.0,
) -> list[str]:
    """Time goes by, all else being well; what was told."""
    start_s = vehicle._now_s
    for tick in range(1, round(seconds / step_s) + 1):
        now_s = start_s + tick * step_s
        battery = None if volt is None else BatteryReading(now_s, volt)
        nav = replace(nav_at(time_s=now_s), yaw_rate_rad_s=yaw_rate_rad_s)
        vehicle.update_state(nav, vehicle.frame, GOOD_FIX, battery, now_s)
        vehicle.decide()
    return [notice.text for notice in vehicle.take_status_texts()]


def lose_operator(vehicle: Vehicle, seconds: float = 10.0) -> list[str]:
    vehicle.failsafes.operator_heard_s = vehicle._now_s
    return live(vehicle, seconds)


def test_an_operator_who_was_never_heard_is_never_missed() -> None:
    assert live(armed_vehicle(), 1000.0) == []


def test_silence_fires_once_and_again_only_after_the_operator_came_back() -> None:
    vehicle = armed_vehicle(long_timeout_s=0.0)
    assert lose_operator(vehicle, 600.0) == ["Failsafe: Operator lost for 5 s", "Mode LOITER: failsafe"]
    vehicle.failsafes.operator_heard_s = vehicle._now_s
    assert live(vehicle, 3.0) == ["Failsafe over: operator heard again", "Failsafe left GUIDED for LOITER"]
    assert "Failsafe: Operator lost for 5 s" in live(vehicle, 5.0)
    vehicle.failsafes.operator_heard_s = vehicle._now_s
    assert live(vehicle, 3.0) == ["Failsafe over: operator heard again"], "it is told once"


def test_no_limit_and_no_monitor_never_fire() -> None:
    assert live(armed_vehicle(battery_low_v=0.0, battery_critical_v=0.0), 60.0, volt=1.0) == []
    assert live(armed_vehicle(), 60.0) == []


def test_a_critical_pack_brings_home_a_boat_that_was_sent_on_when_it_was_low() -> None:
    vehicle = armed_vehicle()
    live(vehicle, 12.0, volt=10.1)
    assert vehicle.request(ChangeMode(Mode.GUIDED)).accepted
    live(vehicle, 60.0, volt=10.1)
    assert vehicle.mode.name == "GUIDED"
    assert "Failsafe: Battery critical: 9.5 V" in live(vehicle, 12.0, volt=9.5)
    assert vehicle.mode.name == "RTL"


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
    vehicle = armed_vehicle(action=int(action))
    texts = lose_operator(vehicle)
    assert texts[0] == "Failsafe: Operator lost for 5 s"
    assert (vehicle.mode, vehicle.armed) == (mode, True)


@pytest.mark.parametrize(
    ("action", "mode"), [(Action.SMART_RTL_OR_RTL, Mode.RTL), (Action.SMART_RTL_OR_HOLD, Mode.HOLD)]
)
def test_a_boat_that_does_not_know_its_track_takes_the_second_choice(action: Action, mode: Mode) -> None:
    vehicle = armed_vehicle(action=int(action))
    vehicle.track.is_incomplete = True
    lose_operator(vehicle)
    assert vehicle.mode == mode


@pytest.mark.parametrize("mode", [Mode.GUIDED, Mode.HOLD])
def test_the_action_disarm_disarms_in_every_mode(mode: Mode) -> None:
    vehicle = armed_vehicle(mode, action=int(Action.DISARM))
    assert "Disarmed by failsafe" in lose_operator(vehicle)
    assert not vehicle.armed


def test_after_a_failsafe_the_operators_choice_stands_however_long_the_trouble_lasts() -> None:
    vehicle = armed_vehicle(action=int(Action.HOLD), long_timeout_s=30.0)
    lose_operator(vehicle)
    assert vehicle.request(ChangeMode(Mode.GUIDED)).accepted
    live(vehicle, 600.0)
    assert vehicle.mode.name == "GUIDED"


# The planner that steers


def guided_by_a_planner() -> Vehicle:
    vehicle = armed_vehicle()
    assert vehicle.request(GoTo(vehicle.frame.to_global(nav_at(500.0).point))).accepted  # type: ignore[union-attr]
    vehicle.failsafes.planner.steers(vehicle._now_s)
    return vehicle


def test_a_planner_that_steers_and_falls_silent_leaves_the_boat_keeping_station() -> None:
    vehicle = guided_by_a_planner()
    assert live(vehicle, 6.0) == ["Failsafe: Planner lost for 5 s", "Mode LOITER: failsafe"]
    vehicle.failsafes.planner.heard(vehicle._now_s)
    assert live(vehicle, 3.0) == ["Failsafe over: planner heard again"]
    assert vehicle.mode.name == "LOITER"


# The hand at the helm


@pytest.mark.parametrize("gives_way", [False, True])
def test_motors_are_not_judged_while_the_boat_gives_way_to_an_obstacle(gives_way: bool) -> None:
    """Both motors go up and down, each in its own time; from 30 s on only the right one turns the bow."""
    vehicle = armed_vehicle()
    told: list[str] = []
    rate = 0.0
    for tick in range(600):
        left = vehicle.board.left if tick < 300 else 0.0
        board = BoardReadings(
            left=0.9 if tick // 15 % 2 else 0.1,
            right=0.9 if tick // 22 % 2 else 0.1,
            judges_motors=not gives_way,
        )
        vehicle.board = board
        rate += 0.1 * (0.4 * (left * abs(left) - board.right * abs(board.right)) - 0.8 * rate)
        told += live(vehicle, 0.1, step_s=0.1, yaw_rate_rad_s=rate)
    assert any(text.endswith("motor gives no thrust") for text in told) is not gives_way


def test_a_new_pack_ends_the_failsafes_of_the_pack_and_no_other() -> None:
    vehicle = armed_vehicle(long_timeout_s=0.0)
    failsafes = vehicle.failsafes
    failsafes.operator_heard_s = 0.0
    live(vehicle, 12.0, volt=9.0)
    assert (failsafes.pack_is_low, failsafes.is_active(Condition.OPERATOR_LOST)) == (True, True)
    failsafes.renew_pack(1.0)
    assert (failsafes.pack_is_low, failsafes.is_active(Condition.OPERATOR_LOST)) == (False, True)
    assert live(vehicle, 3.0, volt=12.0) == [], "the operator's failsafe does not fire again"


def escalation_of(condition: Condition, text: str) -> Escalation:
    """Has just fired, at 0 s."""
    escalation = Escalation(next(row for row in ROWS if row.condition is condition))
    assert escalation.update(text, Failsafe(), 0.0) is Change.FIRES
    return escalation


def test_a_condition_that_lasts_for_another_reason_is_told_again_once_that_is_certain() -> None:
    gnss = escalation_of(Condition.GNSS_BAD, "GPS lost: dead reckoning")
    gnss.update("GPS late", Failsafe(), 2.0)
    assert gnss.update("GPS late", Failsafe(), 4.9) is Change.STAYS
    assert gnss.update("GPS late", Failsafe(), 5.0) is Change.NEW_REASON
    assert gnss.update("GPS late", Failsafe(), 50.0) is Change.STAYS


def test_a_reason_that_comes_and_goes_is_not_told() -> None:
    gnss = escalation_of(Condition.GNSS_BAD, "GPS jumping: rejected")
    for second in range(1, 60):
        text = "GPS lost: dead reckoning" if second % 3 else "GPS jumping: rejected"
        assert gnss.update(text, Failsafe(), float(second)) is Change.STAYS


def test_another_figure_is_no_other_reason() -> None:
    capsized = Escalation(next(row for row in ROWS if row.condition is Condition.CAPSIZED))
    changes = {
        capsized.update(f"Capsized: roll {-second}, pitch 4", Failsafe(), second) for second in range(60)
    }
    assert changes == {Change.STAYS, Change.FIRES}


def test_a_new_reason_is_told_and_changes_nothing() -> None:
    vehicle = armed_vehicle(gnss_action=int(Action.LOITER_OR_HOLD))
    assert vehicle.mode is Mode.GUIDED

    def sees(fault: EstimateFault) -> list[str]:
        for _ in range(40):
            now_s = vehicle._now_s + 0.1
            nav = replace(nav_at(time_s=now_s), faults=int(fault))
            vehicle.update_state(nav, vehicle.frame, GOOD_FIX, None, now_s)
            vehicle.decide()
        return [notice.text for notice in vehicle.take_status_texts()]

    assert sees(EstimateFault.GNSS_LOST) == ["Failsafe: GPS lost: dead reckoning", "Mode LOITER: failsafe"]
    assert vehicle.request(ChangeMode(Mode.GUIDED)).accepted
    vehicle.take_status_texts()
    assert sees(EstimateFault.GNSS_LATE) == ["Failsafe: GPS late: compensated"]
    assert vehicle.mode is Mode.GUIDED


def test_a_loose_contact_is_told_a_few_times_and_then_taken_for_one_trouble() -> None:
    gnss = Escalation(next(row for row in ROWS if row.condition is Condition.GNSS_BAD))
    told = []
    for tick in range(6000):  # ten minutes: lost for half a second, good for 3.5 s
        now_s = 0.1 * tick
        change = gnss.update("GPS lost: dead reckoning" if tick % 40 < 5 else "", Failsafe(), now_s)
        told += [now_s] if change is not Change.STAYS else []
    assert len(told) == 3
    assert max(told) < 10.0
    for tick in range(6000, 6100):
        assert gnss.update("", Failsafe(), 0.1 * tick) in (Change.STAYS, Change.ENDS)
    assert not gnss.is_active


def test_a_failsafe_that_acts_fires_again_however_often_its_condition_comes_and_goes() -> None:
    row = next(row for row in ROWS if row.condition is Condition.OPERATOR_LOST)
    operator, fired = Escalation(row), 0
    for tick in range(1200):  # two minutes of a bad link: lost for 3 s, heard for 3 s
        text = "Operator lost for 5 s" if tick % 60 < 30 else ""
        change = operator.update(text, Failsafe(), 0.1 * tick)
        fired += change is Change.FIRES
    assert fired == 20
