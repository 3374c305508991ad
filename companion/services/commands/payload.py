"""Payload commands by hand: the actions of mission items, at once."""

from companion.core.status_text import Severity
from companion.mavlink.dialect import constants, dialect
from companion.payload.actions import ActionFault
from companion.services.commands.command import Command, CommandTable, Result
from companion.services.payload.rows import ROWS, read_action
from companion.services.statustext import StatusTextService
from companion.vehicle.payload_control import PayloadControl

# Not idempotent
NOT_TWICE = constants(
    *("MAV_CMD", "DO_REPEAT_SERVO", "DO_REPEAT_RELAY", "DO_WINCH", "DO_SEND_SCRIPT_MESSAGE"),
    *("DO_DIGICAM_CONTROL", "IMAGE_START_CAPTURE"),
)


def payload_commands(payload: PayloadControl, texts: StatusTextService) -> CommandTable:
    return dict.fromkeys(ROWS, lambda command: act(command, payload, texts))


def act(command: Command, payload: PayloadControl, texts: StatusTextService) -> Result:
    """Carry out a payload command, or say why not."""
    p = (*command.p, command.fifth, command.sixth, command.altitude_m)
    action = read_action(command.number, p, payload.fitted)
    if isinstance(action, ActionFault):
        fault, result = action.text, Result.DENIED if action.parameter else Result.UNSUPPORTED
    else:
        fault, result = payload.perform(action, command.now_s), Result.REJECTED_FOR_NOW
    if not fault:
        return Result.ACCEPTED
    name = dialect.enums["MAV_CMD"][command.number].name.removeprefix("MAV_CMD_")
    texts.notify(Severity.ERROR, f"{name}: {fault}")
    return result
