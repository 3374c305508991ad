"""MAV_CMD_INJECT_FAILURE: makes emulated hardware fail."""

from collections.abc import Callable

from companion.core.status_text import Severity, StatusText
from companion.hal.interfaces import FaultInjector
from companion.mavlink.dialect import dialect
from companion.services.commands.command import ACCEPTED, DENIED, UNSUPPORTED, Command
from companion.services.commands.vehicle import SendTexts


class FaultCommands:
    """Passes the command to the hardware. Without a fault injector the table is empty."""

    def __init__(self, injector: FaultInjector | None, send_texts: SendTexts) -> None:
        self._injector = injector
        self._send_texts = send_texts
        self.table: dict[int, Callable[[Command], int]] = {}
        if injector is not None:
            self.table[dialect.MAV_CMD_INJECT_FAILURE] = self._inject

    def _inject(self, command: Command) -> int:
        unit, failure, instance = command.whole(0), command.whole(1), command.whole(2)
        if self._injector is None or unit is None or failure is None or instance is None:
            return DENIED
        done = self._injector.inject(unit, failure, instance)
        if done is None:
            return UNSUPPORTED
        self._send_texts([StatusText(Severity.WARNING, f"Fault: {done}")])
        return ACCEPTED
