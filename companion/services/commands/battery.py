"""BATTERY_RESET: the pack was changed or charged."""

from companion.core.status_text import Severity
from companion.sensors.fuel_gauge import FuelGauge
from companion.services.commands.command import ACCEPTED, DENIED, FAILED, REJECTED_FOR_NOW, Command
from companion.services.telemetry.statustext import StatusTextService
from companion.vehicle.vehicle import Vehicle

_FIRST_PACK = 1


def reset_battery(command: Command, vehicle: Vehicle, gauge: FuelGauge, texts: StatusTextService) -> int:
    """Set the fuel gauge and end the battery failsafes.

    param1: bit mask of packs, of which the boat has the first; param2: charge in percent.
    """
    packs, percent = command.whole(0), command.p[1]
    if packs is None or packs < 0 or not 0.0 <= percent <= 100.0:
        return DENIED
    if not packs & _FIRST_PACK or not vehicle.has_battery_monitor:
        texts.notify(Severity.ERROR, "Battery: no such monitor")
        return FAILED
    if vehicle.armed:
        texts.notify(Severity.ERROR, "Battery: disarm first")
        return REJECTED_FOR_NOW
    gauge.reset(percent / 100.0)
    vehicle.failsafes.renew_pack(percent / 100.0)
    texts.notify(Severity.NOTICE, f"Battery set to {percent:.0f} %")
    return ACCEPTED
