"""MAV_CMD_INJECT_FAILURE: makes emulated hardware fail."""

from companion.core.status_text import Severity
from companion.hal.interfaces import FaultInjector
from companion.services.commands.command import ACCEPTED, DENIED, UNSUPPORTED, Command
from companion.services.telemetry.statustext import StatusTextService


def inject_fault(command: Command, injector: FaultInjector, texts: StatusTextService) -> int:
    """Pass the command to the hardware."""
    unit, failure, instance = command.whole(0), command.whole(1), command.whole(2)
    if unit is None or failure is None or instance is None:
        return DENIED
    done = injector.inject(unit, failure, instance)
    if done is None:
        return UNSUPPORTED
    texts.notify(Severity.WARNING, f"Fault: {done}")
    return ACCEPTED
