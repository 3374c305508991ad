"""What stations ask of the vehicle, one function a request: carried out at once or not at all; and what its
mission asks of it besides an intent: homes, and what follows the last item, RTL or what MIS_DONE_BEHAVE says.
"""

from companion.core import requests
from companion.core.geo import LatLon
from companion.core.intent import Intent, KeepStation, Stop
from companion.core.modes import Mode, mode_from_number
from companion.core.requests import ACCEPTED, Outcome, Request
from companion.core.status_text import Severity
from companion.vehicle.modes.controller import ModeInputs
from companion.vehicle.modes.rtl import home_fault
from companion.vehicle.vehicle_core import VehicleCore

_STOP = Stop()
_HOLD = 0  # of MIS_DONE_BEHAVE; else LOITER
_NOT_GUIDED = Outcome(False, "not in GUIDED")
_NOT_THE_LEAD = Outcome(False, "not the one to follow")


def execute(request: Request, vehicle: VehicleCore, now_s: float) -> Outcome:
    """Do it, or say why not."""
    match request:
        case requests.ManualControl():
            if request.throttle is None and request.steering is None:
                vehicle.manual_input.release()
            else:
                vehicle.manual_input.ingest(request, now_s)
            return ACCEPTED
        case requests.SetPoint():
            if not vehicle.is_guided:
                return _NOT_GUIDED
            vehicle.modes.guided.hold(request, now_s)
            return ACCEPTED
        case requests.OtherVehicle():
            is_lead = vehicle.modes.follow.ingest(request, vehicle.config.follow, now_s)
            return ACCEPTED if is_lead else _NOT_THE_LEAD
        case requests.Arm(force):
            return vehicle.arm(force)
        case requests.Disarm(reason):
            return vehicle.disarm(reason)
        case requests.ChangeMode(number, is_initial):
            mode = mode_from_number(number)
            if mode is None:
                return vehicle.refuse(f"Mode {number} is not available on this boat")
            return vehicle.change_mode(mode, "mode switch") if is_initial else vehicle.select_mode(mode)
        case requests.StartMission(first_seq):
            return _start_mission(vehicle, first_seq)
        case requests.SetCurrentItem():
            return _set_current(vehicle, request)
        case requests.GoTo():
            return _go_to(vehicle, request)
        case requests.ChangeSpeed(speed_m_s):
            if vehicle.mode is Mode.AUTO:
                vehicle.progress.speed_m_s = speed_m_s
            else:
                vehicle.speed_m_s = speed_m_s
            return ACCEPTED
        case requests.SetHome(position):
            return _set_home(vehicle, position)


def _start_mission(vehicle: VehicleCore, first_seq: int | None) -> Outcome:
    progress = vehicle.progress
    if first_seq is not None and not progress.set_current(max(first_seq, 1)):
        return vehicle.refuse(f"Mission has no item {first_seq} (last is {progress.last_seq})")
    return vehicle.select_mode(Mode.AUTO)


def _set_current(vehicle: VehicleCore, request: requests.SetCurrentItem) -> Outcome:
    progress = vehicle.progress
    seq = progress.current_seq if request.seq is None else request.seq
    is_named_or_over = request.seq is not None or progress.finished
    if is_named_or_over and not progress.set_current(seq):
        return vehicle.refuse(f"Mission has no item {seq} (last is {progress.last_seq})")
    if request.reset:
        progress.jumps.clear()
    return ACCEPTED


def _go_to(vehicle: VehicleCore, request: requests.GoTo) -> Outcome:
    if vehicle.frame is not None and not vehicle.fence.allows(vehicle.frame.to_local(request.position)):
        return vehicle.refuse("Go to: outside the fence")
    if not vehicle.is_guided:
        if not request.change_mode:
            return vehicle.refuse("Go to: not in GUIDED")
        outcome = vehicle.select_mode(Mode.GUIDED)
        if not outcome.accepted:
            return outcome
    if request.speed_m_s is not None:
        vehicle.speed_m_s = request.speed_m_s
    vehicle.modes.guided.go_to(request.position)
    return ACCEPTED


def _set_home(vehicle: VehicleCore, position: LatLon | None) -> Outcome:
    if position is None:
        if vehicle.nav is None or vehicle.frame is None:
            return vehicle.refuse("Home: no position yet")
        position = vehicle.frame.to_global(vehicle.nav.point)
    if fault := home_fault(position, vehicle.frame):
        return vehicle.refuse(f"Home: {fault}")
    vehicle.home, vehicle.is_home_set = position, True
    return ACCEPTED


def follow_mission(vehicle: VehicleCore, intent: Intent, inputs: ModeInputs) -> Intent:
    """Do what the mission asks of the vehicle besides its intent, and end it."""
    if vehicle.is_returning_from_mission and vehicle.route.has_arrived:
        vehicle.is_returning_from_mission = False
        vehicle.notify(Severity.NOTICE, "Mission complete")
    if vehicle.mode is not Mode.AUTO:
        return intent
    for position in vehicle.progress.take_homes():
        _set_home(vehicle, position)
    return _end_mission(vehicle, intent, inputs) if vehicle.progress.finished else intent


def _end_mission(vehicle: VehicleCore, intent: Intent, inputs: ModeInputs) -> Intent:
    if vehicle.progress.go_home and vehicle.change_mode(Mode.RTL, "mission item").accepted:
        vehicle.is_returning_from_mission = True
        # An item may have moved home just now
        vehicle.route.prepare(inputs.frame, vehicle.home, vehicle.config)
        return vehicle.modes.rtl.intent(inputs)
    vehicle.notify(Severity.NOTICE, "Mission complete")
    if vehicle.config.mission.done_behave == _HOLD:
        vehicle.change_mode(Mode.HOLD, "mission complete")
        return _STOP
    vehicle.change_mode(Mode.LOITER, "mission complete")
    if isinstance(intent, KeepStation):
        vehicle.modes.loiter.move_to(inputs.frame.to_global(intent.point))
    return intent
