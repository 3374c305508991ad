"""The parameter protocol: list, read, set. Values are C-cast floats, as ArduPilot's are."""

from collections import deque

from companion.config.parameter_pack import PackError, unpack_upload
from companion.config.parameters import Parameters
from companion.core.status_text import Severity, StatusText
from companion.mavlink.dialect import Message, dialect
from companion.persistence.losses import Losses
from companion.services.ftp.frames import Code, Refusal
from companion.services.outbox import Origin, Outbox
from companion.services.telemetry.statustext import StatusTextService

_LIST_PER_TICK = 250  # all there are, where the line is fast; a slow one takes what it has room for
_STORED = "parameters"  # their name among the losses
_VALUE_BYTES = 37  # a PARAM_VALUE on the line
_ANSWERS_PER_TICK = 50  # PARAM_VALUEs after a save: 200 changes at once are answered within four ticks
_MOST_ANSWERS = 1000  # for one name that is changed again and again while the medium takes its time
_NAMED_REASONS = 3  # of a refused file; the others are only counted


class ParameterService:
    """Answers a change once the medium has it, all else at once; a list goes out over the following ticks.

    A value that the medium refuses stays in use until the restart: it is answered, and the operator is told.
    """

    def __init__(
        self, parameters: Parameters, outbox: Outbox, texts: StatusTextService, losses: Losses | None = None
    ) -> None:
        self._losses = losses or Losses()
        if parameters.loss:
            self._losses.add(_STORED, parameters.loss, "Set any parameter to keep what is in use")
        self._parameters = parameters
        self._answers: deque[tuple[int, float]] = deque()  # values that the medium has, still to send
        self._answers_left = _ANSWERS_PER_TICK
        self._outbox = outbox
        self._texts = texts
        self._listing: dict[int, deque[int]] = {}  # by channel: the indexes still to send
        self._left = _LIST_PER_TICK  # how many of all lists may still go out before the next tick

    def on_request_list(self, origin: Origin) -> None:
        """PARAM_REQUEST_LIST: (re)start the list on the channel it came from."""
        self._listing[origin.channel] = deque(range(len(self._parameters.rows)))
        self._continue_list(origin.channel)

    def on_request_read(self, message: Message, origin: Origin) -> None:
        """PARAM_REQUEST_READ by index, or by name when the index is −1. What does not exist is not answered:
        the protocol has no refusal."""
        index: int | None = message.param_index
        if message.param_index < 0:
            index = self._parameters.index_of(_name(message.param_id))
        if index is None or index >= len(self._parameters.rows):
            return
        if not self._parameters.is_unsaved(self._parameters.rows[index].name):  # else an answer comes anyway
            self._outbox.send(origin.channel, self._value(index))

    def on_set(self, message: Message) -> None:
        """PARAM_SET: everyone hears the stored value, also when the change was refused."""
        if reason := self.set(_name(message.param_id), message.param_value):
            self._texts.send([StatusText(Severity.WARNING, reason)])

    def set(self, name: str, value: float) -> str:
        """Change one; everyone hears the value, and those of other names for the same setting, once the
        medium has them. Returns why not, empty if changed."""
        reason = self._parameters.set(name, value)
        if reason and not self._parameters.is_unsaved(name):
            for index in self._parameters.sharing(name):
                self._outbox.broadcast(self._value(index))
        self._answer()
        return reason

    def value(self, name: str) -> float:
        """The present one, as stations see it.

        Raises:
            KeyError: no such parameter.
        """
        index = self._parameters.index_of(name)
        if index is None:
            raise KeyError(name)
        return self._parameters.value(self._parameters.rows[index])

    def reset(self) -> None:
        """Go back to the boat's file; everyone hears the values that have changed."""
        self._parameters.reset()
        self._answer()

    def set_from_file(self, file: bytes) -> None:
        """A packed file sets many at once; everyone hears the values that have changed.

        Raises:
            Refusal: it is no such file; nothing has been changed.
        """
        try:
            values = unpack_upload(file)
        except PackError as error:
            self._texts.send([StatusText(Severity.WARNING, f"Parameter file refused: {error}")])
            raise Refusal(Code.FAIL) from None
        reasons = self._parameters.set_many(values)
        self._answer()
        told = reasons[:_NAMED_REASONS]
        if len(reasons) > len(told):
            told.append(f"{len(reasons) - len(told)} more parameters refused")
        self._texts.send([StatusText(Severity.WARNING, reason) for reason in told])

    def forget(self, channel: int) -> None:
        """A channel has closed."""
        self._listing.pop(channel, None)

    def tick(self) -> None:
        """Go on with the lists under way, and answer the changes that the medium has taken or refused."""
        self._answers_left = _ANSWERS_PER_TICK
        self._answer()
        self._left = _LIST_PER_TICK
        if self._listing:
            for channel in list(self._listing):
                self._continue_list(channel)

    def _continue_list(self, channel: int) -> None:
        """Send of a list what the line has room for now."""
        queue = self._listing[channel]
        while queue and self._left > 0 and self._outbox.has_room(channel):
            self._left -= 1
            self._outbox.send_bulk(channel, self._value(queue.popleft()), _VALUE_BYTES)
        if not queue:
            del self._listing[channel]

    def _answer(self) -> None:
        for values, counts, error in self._parameters.poll_saves():
            if error:
                self._texts.send([StatusText(Severity.ERROR, f"Parameters not stored: {error}")])
            else:
                self._losses.end(_STORED)
            for name, value in values.items():
                index = self._parameters.index_of(name)
                if index is not None:
                    self._answers.extend([(index, value)] * min(counts[name], _MOST_ANSWERS))
        while self._answers and self._answers_left > 0:
            self._answers_left -= 1
            self._outbox.broadcast(self._value(*self._answers.popleft()))

    def _value(self, index: int, value: float | None = None) -> Message:
        """A parameter's present value, or another one."""
        row = self._parameters.rows[index]
        return dialect.MAVLink_param_value_message(
            param_id=row.name.encode("ascii"),
            param_value=self._parameters.value(row) if value is None else value,
            param_type=int(row.kind),
            param_count=len(self._parameters.rows),
            param_index=index,
        )


def _name(param_id: str | bytes) -> str:
    text = param_id.decode("ascii", errors="replace") if isinstance(param_id, bytes) else param_id
    return text.rstrip("\x00")
