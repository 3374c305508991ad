"""What follows a mission's last item: RTL as an item, or what MIS_DONE_BEHAVE says."""

from typing import TYPE_CHECKING

from companion.core.intent import Intent, KeepStation, Stop
from companion.core.modes import Mode
from companion.core.requests import SetHome
from companion.core.status_text import Severity
from companion.vehicle.modes.controller import ModeInputs

if TYPE_CHECKING:
    from companion.vehicle.vehicle import Vehicle

_STOP = Stop()
_HOLD = 0  # of MIS_DONE_BEHAVE; else LOITER


def follow_mission(vehicle: "Vehicle", intent: Intent, inputs: ModeInputs) -> Intent:
    """Do what the mission asks of the vehicle besides its intent, and end it."""
    if vehicle.is_returning_from_mission and vehicle.route.has_arrived:
        vehicle.is_returning_from_mission = False
        vehicle.notify(Severity.NOTICE, "Mission complete")
    if vehicle.mode is not Mode.AUTO:
        return intent
    for position in vehicle.progress.take_homes():
        vehicle.request(SetHome(position))
    return _end_mission(vehicle, intent, inputs) if vehicle.progress.finished else intent


def _end_mission(vehicle: "Vehicle", intent: Intent, inputs: ModeInputs) -> Intent:
    if vehicle.progress.go_home and vehicle.change_mode(Mode.RTL, "mission item").accepted:
        vehicle.is_returning_from_mission = True
        return vehicle.modes.rtl.intent(inputs)
    vehicle.notify(Severity.NOTICE, "Mission complete")
    if vehicle.config.mission.done_behave == _HOLD:
        vehicle.change_mode(Mode.HOLD, "mission complete")
        return _STOP
    vehicle.change_mode(Mode.LOITER, "mission complete")
    if isinstance(intent, KeepStation):
        vehicle.modes.loiter.move_to(inputs.frame.to_global(intent.point))
    return intent
