"""Between the vehicle and its failsafes: what they look at, and what the vehicle does about it."""

import math

from msgspec.structs import replace

from companion.core.intent import Intent
from companion.core.modes import Mode
from companion.core.state import lacks_heading
from companion.core.status_text import Severity
from companion.failsafe import actions
from companion.failsafe.actions import Trigger
from companion.failsafe.inputs import FailsafeInputs, may_drift
from companion.failsafe.monitor import PERIOD_S, Change
from companion.failsafe.response import RECHECK_DRIFT_S, respond, routine_check
from companion.failsafe.table import Condition
from companion.vehicle.vehicle_core import NO_HEADING, VehicleCore


def run_failsafes(vehicle: VehicleCore, now_s: float) -> None:
    """One cycle: look, decide, and do it."""
    _observe(vehicle, now_s)
    inputs = failsafe_inputs(vehicle, now_s)
    for alarm in vehicle.failsafes.update(inputs):
        # An alarm before may have changed the mode
        seen = replace(inputs, mode=vehicle.mode, armed=vehicle.armed, recovery=vehicle.recovery.state)
        for decision in respond(alarm, seen):
            _carry_out(decision, vehicle, now_s)
        if alarm.change is Change.ENDS and alarm.row.condition is Condition.OPERATOR_LOST:
            _tell_missed_retreat(vehicle)
    is_due = inputs.needs_motor_check or inputs.needs_motor_comparison
    if is_due and not vehicle.failsafes.is_suspended(now_s):
        seen = replace(inputs, mode=vehicle.mode, armed=vehicle.armed, recovery=vehicle.recovery.state)
        for decision in routine_check(seen):
            _carry_out(decision, vehicle, now_s)


def _observe(vehicle: VehicleCore, now_s: float) -> None:
    """Feed all that learns over cycles: endurance, fence, motors and rudder."""
    failsafes, config, board = vehicle.failsafes, vehicle.config, vehicle.board
    nav, frame, battery = vehicle.nav, vehicle.frame, vehicle.battery
    motors, rudder, endurance = failsafes.motors, failsafes.rudder, failsafes.endurance
    if failsafes.is_suspended(now_s):
        motors.pause()
        rudder.pause()
        return
    if endurance.is_due(now_s):
        home = None if vehicle.home is None or frame is None else frame.to_local(vehicle.home)
        home_m = math.inf if nav is None else vehicle.route.home_distance_m(nav.point)
        endurance.compare(nav, home, home_m, battery, board.consumed_mah, config, now_s)
    endurance.learn(battery, nav, config, PERIOD_S)
    failsafes.fence.update(vehicle.fence, nav, config.motors, now_s)
    if not vehicle.is_guided and not failsafes.is_active(Condition.PLANNER_LOST):
        failsafes.planner.release()
    if not vehicle.mode.rules.is_by_hand and not failsafes.is_active(Condition.HELM_LOST):
        failsafes.sticks.stop_watching()
    if not vehicle.armed:
        motors.rearm()
        rudder.rearm()
    # One motor alone moves the hull as no model says
    if (
        vehicle.recovery.hides_motors
        or not board.judges_motors
        or vehicle.recovery.motor_check.motors.has_failed
        or failsafes.is_postponed
    ):
        motors.pause()
    else:
        motors.update(
            board.left,
            board.right,
            nav,
            vehicle.fix,
            battery,
            config,
            now_s,
            PERIOD_S,
            board.rudder,
            board.escs,
        )
    if vehicle.recovery.hides_motors:
        rudder.rearm()  # judged anew afterwards
    elif board.judges_motors and not failsafes.is_postponed:
        rudder.update(0.5 * (board.left + board.right), board.rudder, nav, config, PERIOD_S)
    else:
        rudder.pause()


def failsafe_inputs(vehicle: VehicleCore, now_s: float) -> FailsafeInputs:
    """All that the failsafes look at."""
    failsafes, config, frame = vehicle.failsafes, vehicle.config, vehicle.frame
    planner, sticks, motors = failsafes.planner, failsafes.sticks, failsafes.motors
    check = vehicle.recovery.motor_check
    station = vehicle.modes.loiter.destination
    return FailsafeInputs(
        now_s=now_s,
        config=config,
        mode=vehicle.mode,
        armed=vehicle.armed,
        nav=vehicle.nav,
        battery=vehicle.battery,
        board=vehicle.board,
        fence=vehicle.fence,
        beyond_fence_m=failsafes.fence.beyond_m,
        station=None if station is None or frame is None else frame.to_local(station),
        operator_silent_s=now_s - failsafes.operator_heard_s,
        planner_silent_s=planner.silent_s(now_s),
        sticks_dropped=sticks.is_lost(config, now_s),
        has_station_sticks=sticks.has_station(config, now_s),
        radio_heard=sticks.rc.is_heard,
        radio_fault=sticks.rc.fault(config.rc, now_s),
        range_fault=failsafes.endurance.range_fault,
        verdict=motors.verdict,
        needs_motor_check=motors.needs_check,
        needs_motor_comparison=motors.needs_comparison,
        failed_motor=check.fault(),
        rudder_fault=failsafes.rudder.fault,
        reversed_motor=check.motors.has_reversed,
        recovery=vehicle.recovery.state,
    )


def _carry_out(decision: actions.Decision, vehicle: VehicleCore, now_s: float) -> None:
    match decision:
        case actions.Notify(severity, text):
            vehicle.notify(severity, text)
        case actions.StopMotors():
            vehicle.disarm("by failsafe")
        case actions.Retreat(modes):
            vehicle.recovery.handle(Trigger.RETREAT if modes else Trigger.ABORT, now_s)
            before = vehicle.mode
            _retreat(modes, vehicle)
            if vehicle.mode is not before:
                nav, frame = vehicle.nav, vehicle.frame
                is_called = before is Mode.AUTO and vehicle.failsafes.pack_is_low
                if is_called and nav is not None and frame is not None:
                    vehicle.progress.leave_leg(nav.point, frame)
                vehicle.retreated_from = vehicle.retreated_from or before
        case actions.LimitSpeed(share):
            vehicle.speed_m_s = share * vehicle.config.speed.cruise_m_s
        case actions.Recover(trigger, severity, text):
            if vehicle.recovery.handle(trigger, now_s):
                if text:
                    vehicle.notify(severity, text)
                if trigger is Trigger.COMPARE:
                    vehicle.recovery.is_left_first = vehicle.failsafes.motors.compare(now_s)
        case actions.AssumeFailed(is_left):
            vehicle.recovery.handle(Trigger.ABORT, now_s)
            vehicle.recovery.motor_check.assume_failed(is_left, now_s)


def _tell_missed_retreat(vehicle: VehicleCore) -> None:
    """The operator was not heard, and may not have heard of the mode that a failsafe has chosen."""
    left, vehicle.retreated_from = vehicle.retreated_from, None
    if vehicle.armed and left is not None:
        vehicle.notify(Severity.NOTICE, f"Failsafe left {left.name} for {vehicle.mode.name}")


def _retreat(modes: tuple[Mode, ...], vehicle: VehicleCore) -> None:
    """Enter the first mode that can be entered. LOITER needs no position: it goes by dead reckoning."""
    nav, timeout_s = vehicle.nav, vehicle.config.motors.estimate_timeout_s
    for mode in modes:
        fault = vehicle.estimate_fault() if mode is Mode.LOITER else ""
        if fault and nav is not None and vehicle.frame is not None and not lacks_heading(nav, timeout_s):
            vehicle.force_mode(mode, "failsafe, by dead reckoning")
            return
        if fault == NO_HEADING:
            vehicle.force_mode(mode, "failsafe, without heading")
            return
        if vehicle.change_mode(mode, "failsafe").accepted:
            return
    vehicle.change_mode(Mode.HOLD, "failsafe")


def run_recovery(vehicle: VehicleCore, now_s: float) -> Intent:
    """Go on with the recovery under way."""
    board = vehicle.board
    nav, config = vehicle.nav, vehicle.config
    seen = None if nav is None else vehicle.voyage.nearest(nav.point, 2.0 * config.fence.margin_m)
    step = vehicle.recovery.update(nav, vehicle.fence, config, board.left, board.right, now_s, seen)
    if step.text:
        vehicle.notify(Severity.WARNING, step.text)
    if step.cleared:
        vehicle.failsafes.motors.clear(now_s)
    elif step.cleared is not None:
        vehicle.failsafes.motors.reset()
    return step.intent


def recheck_motors(vehicle: VehicleCore, now_s: float) -> None:
    """Check a failed motor again from time to time, where the boat has room to drift."""
    check = vehicle.recovery.motor_check
    if not check.motors.has_failed:
        return
    has_room = may_drift(vehicle.nav, vehicle.fence, RECHECK_DRIFT_S)
    if check.is_due(now_s, has_room=has_room):
        vehicle.recovery.handle(Trigger.CHECK, now_s)
