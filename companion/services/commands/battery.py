"""BATTERY_RESET: the pack was changed or charged."""

from collections.abc import Callable

from companion.core.status_text import Severity, StatusText
from companion.mavlink.dialect import dialect
from companion.sensors.fuel_gauge import FuelGauge
from companion.services.commands.command import ACCEPTED, DENIED, FAILED, REJECTED_FOR_NOW, Command
from companion.services.commands.vehicle import SendTexts
from companion.vehicle.vehicle import Vehicle

_FIRST_PACK = 1


class BatteryCommands:
    """Sets the fuel gauge and ends the battery failsafes."""

    def __init__(self, vehicle: Vehicle, gauge: FuelGauge, send_texts: SendTexts) -> None:
        self._vehicle = vehicle
        self._gauge = gauge
        self._send_texts = send_texts
        self.table: dict[int, Callable[[Command], int]] = {dialect.MAV_CMD_BATTERY_RESET: self._reset}

    def _reset(self, command: Command) -> int:
        """param1: bit mask of packs, of which the boat has the first; param2: charge in percent."""
        packs, percent = command.whole(0), command.p[1]
        if packs is None or packs < 0 or not 0.0 <= percent <= 100.0:
            return DENIED
        if not packs & _FIRST_PACK or self._vehicle.battery is None:
            return self._report(FAILED, Severity.ERROR, "Battery: no such monitor")
        if self._vehicle.armed:
            return self._report(REJECTED_FOR_NOW, Severity.ERROR, "Battery: disarm first")
        self._gauge.reset(percent / 100.0)
        self._vehicle.failsafes.renew_pack(percent / 100.0)
        return self._report(ACCEPTED, Severity.NOTICE, f"Battery set to {percent:.0f} %")

    def _report(self, result: int, severity: int, text: str) -> int:
        self._send_texts([StatusText(severity, text)])
        return result
