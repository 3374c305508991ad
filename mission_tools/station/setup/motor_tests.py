"""Turning a disarmed boat's motors a little while somebody holds a button.

Theory of operation
-------------------
The page repeats its request while the button is held. Each request becomes one DO_MOTOR_TEST of TEST_S.
This station never repeats it by itself: a repetition that comes after the test's end would turn a motor
that nobody asks for any more. So the motors stop TEST_S after the page, this server or the link falls
silent, by the boat's own clock. The boat takes an equal command within two seconds for a repetition and
does not carry it out, so two durations alternate.

A press has a name, and each request says how long the button has been held. A request that comes later after
the first one than that was held up on its way and is refused, as is one of a press that has ended.

The stop is sent STOPS times, since the boat may miss one, and is answered when the boat has acknowledged
one and says that its motors are at rest.
"""

from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, Final, NamedTuple

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.outcome import Accepted, Answered, Outcome, Refused, Silent
from mission_tools.station.requests import BadRequestError, number_of
from mission_tools.station.texts import Text
from mission_tools.station.wire import command_long
from mission_tools.station.words import say

TEST_S: Final = 1.0
_OTHER_S: Final = 0.95
MOST_PERCENT: Final = 50.0
LATE_S: Final = 0.5
STOPS: Final = 4
_STOP_EVERY_S: Final = 0.15
_SETTLE_S: Final = 0.3  # for the text that says why not, as for other commands
_TURN_ANSWER_S: Final = 3.0
_STOP_ANSWER_S: Final = 6.0
_SHOWN_S: Final = 1.5  # after a test the boat's heartbeat still says armed, until the next one that is heard
_MOST_WAITING: Final = 32
_ENDED_PRESSES: Final = 16
_MOST_NAME: Final = 64
_WARNING: Final = 4

MOTORS: Final = {"both": 1, "turn": 2, "left": 3, "right": 4}  # as ArduPilot Rover numbers them
STOPPED: Final = say("answer.motor_rest")
TURNING: Final = say("answer.motor_turning")
HELD_UP: Final = say("answer.motor_held_up")
ENDED: Final = say("answer.motor_ended")
NO_ANSWER: Final = say("answer.motor_silent")
REFUSED: Final = say("answer.refused")


class _Waiting(NamedTuple):
    answered: Answered
    until_s: float


class MotorTests:
    """The motor tests of one boat. send: to this boat."""

    def __init__(self, boat: Address, own: Address, send: Callable[[Message], None]) -> None:
        self._boat, self._own, self._send = boat, own, send
        self._press: str | None = None
        self._began_s = self._held_before_s = 0.0
        self._ended: deque[str] = deque(maxlen=_ENDED_PRESSES)
        self._turned_s = float("-inf")
        self._is_other = False
        self._waiting: list[_Waiting] = []
        self._refused_s: float | None = None
        self._texts: list[str] = []
        self._stops_left = 0
        self._stop_s = 0.0
        self._stopping: list[_Waiting] = []
        self._is_stop_heard = False

    def is_own(self, now_s: float) -> bool:
        """Whether the boat's heartbeat may say armed because of a test of this station."""
        return now_s - self._turned_s < TEST_S + _SHOWN_S

    def turn(self, arguments: Mapping[str, Any], answered: Answered, now_s: float) -> None:
        """Turn a motor for TEST_S; BadRequestError says what is wrong with the request."""
        motor, percent, press = (
            arguments.get("motor"),
            number_of(arguments, "percent"),
            arguments.get("press"),
        )
        held_s = number_of(arguments, "held_s")
        if not isinstance(motor, str) or motor not in MOTORS:
            raise BadRequestError(say("answer.no_motor", motors=", ".join(MOTORS)))
        if not 0.0 < abs(percent) <= MOST_PERCENT:
            raise BadRequestError(say("answer.no_power", n=percent, most=MOST_PERCENT))
        if not isinstance(press, str) or not 0 < len(press) <= _MOST_NAME:
            raise BadRequestError(say("answer.no_press"))
        if press in self._ended or self._refused_s is not None or len(self._waiting) >= _MOST_WAITING:
            answered(Refused(ENDED))
            return
        if press != self._press:
            self.end_press()
            self._press, self._began_s, self._held_before_s = press, now_s, held_s
        elif now_s - self._began_s > held_s - self._held_before_s + LATE_S:
            self.end_press()
            answered(Refused(HELD_UP))
            return
        self._stops_left = 0
        self._end_stops(Accepted(STOPPED))
        self._waiting.append(_Waiting(answered, now_s + _TURN_ANSWER_S))
        self._is_other = not self._is_other
        self._turned_s = now_s
        self._command(MOTORS[motor], percent, _OTHER_S if self._is_other else TEST_S)

    def stop(self, answered: Answered, now_s: float) -> None:
        """Stop them at once."""
        self.end_press()
        self._stopping.append(_Waiting(answered, now_s + _STOP_ANSWER_S))
        self._is_stop_heard = False
        self._stops_left, self._stop_s = STOPS, now_s
        self._repeat_stop(now_s)

    def end_press(self) -> None:
        """Another request goes to the boat, which ends its test: the press must not turn a motor again."""
        if self._press is not None:
            self._ended.append(self._press)
            self._press = None

    def on_ack(self, message: Message, now_s: float) -> None:
        """COMMAND_ACK of the boat."""
        if message.command != dialect.MAV_CMD_DO_MOTOR_TEST or message.target_system not in (
            0,
            self._own.system,
        ):
            return
        if message.result == dialect.MAV_RESULT_ACCEPTED:
            self._is_stop_heard = True
            self._answer_waiting(Accepted(TURNING))
        elif self._waiting and self._refused_s is None:
            self.end_press()
            self._refused_s = now_s + _SETTLE_S

    def on_text(self, text: Text) -> None:
        """A STATUSTEXT of the boat: it may say why it refuses."""
        if self._waiting and text.severity <= _WARNING and text.text.startswith("Motor test: "):
            self._texts = [text.text.removeprefix("Motor test: ")]

    def poll(self, now_s: float, is_armed: bool | None) -> None:
        """Repeat the stop, answer what is settled, give up. is_armed: by the boat's latest heartbeat."""
        self._repeat_stop(now_s)
        if self._refused_s is not None and now_s >= self._refused_s:
            self._answer_waiting(Refused("".join(self._texts) or REFUSED))
        late = [one for one in self._waiting if now_s >= one.until_s]
        self._waiting = [one for one in self._waiting if now_s < one.until_s]
        for one in late:
            one.answered(Silent(NO_ANSWER))
        if self._stopping and self._is_stop_heard and not (is_armed and self.is_own(now_s)):
            self._end_stops(Accepted(STOPPED))
        if any(now_s >= one.until_s for one in self._stopping):
            self._end_stops(Silent(NO_ANSWER))

    def _answer_waiting(self, outcome: Outcome) -> None:
        waiting, self._waiting = self._waiting, []
        self._refused_s, self._texts = None, []
        for one in waiting:
            one.answered(outcome)

    def _end_stops(self, outcome: Outcome) -> None:
        stopping, self._stopping = self._stopping, []
        for one in stopping:
            one.answered(outcome)

    def _repeat_stop(self, now_s: float) -> None:
        if self._stops_left and now_s >= self._stop_s:
            self._stops_left -= 1
            self._stop_s = now_s + _STOP_EVERY_S
            self._command(MOTORS["both"], 0.0, 0.0)

    def _command(self, motor: int, percent: float, duration_s: float) -> None:
        number = dialect.MAV_CMD_DO_MOTOR_TEST
        self._send(command_long(self._boat, number, motor, 0.0, percent, duration_s))
