"""The requests that set a boat up, as a table."""

from collections.abc import Callable, Mapping
from typing import Any, Final

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.outcome import Answered, Refused
from mission_tools.station.setup.calibrations import KINDS, Calibrations
from mission_tools.station.setup.motor_tests import MotorTests
from mission_tools.station.texts import Text
from mission_tools.station.words import say

_PROGRESS: Final = dialect.MAVLINK_MSG_ID_MAG_CAL_PROGRESS
_REPORT: Final = dialect.MAVLINK_MSG_ID_MAG_CAL_REPORT
MESSAGES: Final = frozenset({_PROGRESS, _REPORT, dialect.MAVLINK_MSG_ID_COMMAND_ACK})
_STARTS: Final = {f"calibrate_{kind}": kind for kind in KINDS}
# What changes nothing that a sailing boat needs, and ends something
_ALWAYS: Final = frozenset({"calibrate_cancel", "motor_stop"})
REQUESTS: Final = frozenset({*_STARTS, *_ALWAYS, "calibrate_accept", "motor"})


def why_not_disarmed(armed: bool | None) -> str:
    """Of a boat that is armed, or may be: None is a boat that is not heard."""
    return say("error.armed") if armed else say("error.armed_unknown")


class Setup:
    """Calibrations and motor tests of one boat. send: to this boat."""

    def __init__(self, boat: Address, own: Address, send: Callable[[Message], None]) -> None:
        self.calibrations = Calibrations(boat, own, send)
        self.motors = MotorTests(boat, own, send)

    def ask(
        self, what: str, arguments: Mapping[str, Any], answered: Answered, armed: bool | None, now_s: float
    ) -> None:
        """Do one of REQUESTS; BadRequestError says what is wrong with it."""
        is_own = what == "motor" and self.motors.is_own(now_s)  # its heartbeat says armed, too
        kind = _STARTS.get(what)
        may = what in _ALWAYS or is_own or (kind is not None and KINDS[kind].while_armed)
        if armed is not False and not may:
            answered(Refused(why_not_disarmed(armed)))
        elif what == "motor":
            self.motors.turn(arguments, answered, now_s)
        elif what == "motor_stop":
            self.motors.stop(answered, now_s)
        elif what == "calibrate_accept":
            self.calibrations.keep(answered, now_s)
        elif what == "calibrate_cancel":
            self.calibrations.cancel(answered, now_s)
        elif kind is not None:
            self.motors.end_press()
            self.calibrations.start(kind, answered, now_s)

    def handle(self, message: Message, now_s: float) -> None:
        """Take a message of one of the kinds in MESSAGES."""
        number = message.get_msgId()
        if number == _PROGRESS:
            self.calibrations.on_progress(message, now_s)
        elif number == _REPORT:
            self.calibrations.on_report(message, now_s)
        else:
            self.motors.on_ack(message, now_s)
            self.calibrations.on_ack(message, now_s)

    def on_text(self, text: Text, now_s: float) -> None:
        """A STATUSTEXT of the boat."""
        self.motors.on_text(text)
        self.calibrations.on_text(text, now_s)

    def poll(self, now_s: float, armed: bool | None) -> None:
        """Repeat, settle, give up."""
        self.motors.poll(now_s, armed)
        self.calibrations.poll(now_s)
