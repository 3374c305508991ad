"""The parameter protocol: list, read, set. Values are C-cast floats, as ArduPilot's."""

from collections import deque
from dataclasses import dataclass, field

from companion.config.parameter_pack import PackError, unpack_upload
from companion.config.parameters import Parameters
from companion.core.status_text import Severity, StatusText
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.ftp_frames import Code, Refusal
from companion.persistence.mission_store import DataLosses
from companion.services.outbox import Origin, Outbox
from companion.services.statustext import StatusTextService

_LIST_PER_TICK = 250  # all parameters on a fast line
_STORED = "parameters"  # their name among the losses
_VALUE_BYTES = 37  # a PARAM_VALUE on the line
_ANSWERS_PER_TICK = 50  # PARAM_VALUEs after a save
_MOST_ANSWERS = 1000  # for one name that is changed repeatedly during a save
_SETS_PER_TICK = 5  # each costs up to 4 ms on a Pi Zero 2 W; stations wait for an answer before the next
_MOST_SETS = 250  # waiting, of a channel: all parameters; a station repeats what is dropped
_NAMED_REASONS = 3  # of a refused file; others are counted


@dataclass(eq=False)
class ParameterService:
    """Confirms a change once it is stored; lists are sent over several ticks.

    A value that cannot be stored stays in use until the restart: it is confirmed, and the operator is told.
    """

    _parameters: Parameters
    _outbox: Outbox
    _texts: StatusTextService
    _losses: DataLosses = field(default_factory=DataLosses)

    def __post_init__(self) -> None:
        if self._parameters.loss:
            self._losses.add(_STORED, self._parameters.loss, "Set any parameter to keep what is in use")
        self._answers: deque[tuple[int, float]] = deque()  # stored values to confirm
        self._listing: dict[int, deque[int]] = {}  # by open channel: indexes to send
        # by channel, in order of their turns: asked for and not yet done
        self._sets: dict[int, deque[tuple[str, float]]] = {}
        self._begin_tick()

    def _begin_tick(self) -> None:
        """What may be done until the next tick."""
        self._sets_left, self._answers_left, self._left = _SETS_PER_TICK, _ANSWERS_PER_TICK, _LIST_PER_TICK

    @property
    def is_busy(self) -> bool:
        is_saving = self._parameters.is_saving
        return is_saving or bool(self._answers or self._sets) or any(self._listing.values())

    def open(self, channel: int) -> None:
        self._listing[channel] = deque()

    def on_request_list(self, origin: Origin) -> None:
        """PARAM_REQUEST_LIST: (re)start the list on its channel."""
        self._listing[origin.channel] = deque(range(len(self._parameters.rows)))
        self._continue_list(origin.channel)

    def on_request_read(self, message: Message, origin: Origin) -> None:
        """PARAM_REQUEST_READ by index, or by name if the index is −1; a refused PARAM_SET, by name. The
        protocol has no refusal.
        """
        index: int | None = getattr(message, "param_index", -1)
        if index is not None and index < 0:
            index = self._parameters.index_of(_name(message.param_id))
        if index is None or index >= len(self._parameters.rows):
            return
        if not self._parameters.is_unsaved(self._parameters.rows[index].name):  # else confirmed later
            self._outbox.send(origin.channel, self._value(index))

    def on_set(self, message: Message, origin: Origin) -> None:
        """PARAM_SET: the stored value is broadcast, even after a refusal. A flood takes several ticks, and
        delays no other channel.
        """
        waiting = self._sets.setdefault(origin.channel, deque())
        if len(waiting) < _MOST_SETS:
            waiting.append((_name(message.param_id), message.param_value))
            self._continue_sets()

    def _continue_sets(self) -> None:
        """One change of each channel in turn."""
        while self._sets and self._sets_left > 0:
            self._sets_left -= 1
            channel = next(iter(self._sets))
            waiting = self._sets.pop(channel)
            name, value = waiting.popleft()
            if waiting:
                self._sets[channel] = waiting
            if reason := self.set(name, value):
                self._texts.notify(Severity.WARNING, reason)

    def set(self, name: str, value: float) -> str:
        """Change a parameter; its value and those of its aliases are broadcast once stored. Returns the
        reason for a refusal, or an empty string.
        """
        reason = self._parameters.set(name, value)
        if reason and not self._parameters.is_unsaved(name):
            for index in self._parameters.sharing(name):
                self._publish(index)
        self._answer()
        return reason

    def value(self, name: str) -> float:
        """The present value, as stations see it. Raises KeyError: no such parameter."""
        index = self._parameters.index_of(name)
        if index is None:
            raise KeyError(name)
        return self._parameters.value(self._parameters.rows[index])

    def reset(self) -> None:
        """Restore the configuration file's values; changes are broadcast."""
        self._parameters.reset()
        self._answer()

    def set_from_file(self, file: bytes) -> None:
        """Set parameters from a packed file; changes are broadcast. After a Refusal nothing has changed."""
        try:
            values = unpack_upload(file)
        except PackError as error:
            self._texts.notify(Severity.WARNING, f"Parameter file refused: {error}")
            raise Refusal(Code.FAIL) from None
        reasons = self._parameters.set_many(values)
        self._answer()
        named = reasons[:_NAMED_REASONS]
        if len(reasons) > len(named):
            named.append(f"{len(reasons) - len(named)} more parameters refused")
        self._texts.send([StatusText(Severity.WARNING, reason) for reason in named])

    def forget(self, channel: int) -> None:
        self._listing.pop(channel, None)
        self._sets.pop(channel, None)

    def tick(self) -> None:
        self._begin_tick()
        self._continue_sets()
        self._answer()
        for channel in self._listing:
            self._continue_list(channel)

    def _continue_list(self, channel: int) -> None:
        """Send as many entries as the line has room for."""
        queue = self._listing[channel]
        while queue and self._left > 0 and self._outbox.has_room(channel):
            self._left -= 1
            self._outbox.send_bulk(channel, self._value(queue.popleft()), _VALUE_BYTES)

    def _answer(self) -> None:
        for values, counts, error in self._parameters.poll_saves():
            if error:
                self._texts.notify(Severity.ERROR, f"Parameters not stored: {error}")
            else:
                self._losses.end(_STORED)
            for name, value in values.items():
                index = self._parameters.index_of(name)
                if index is not None:
                    self._answers.extend([(index, value)] * min(counts[name], _MOST_ANSWERS))
        while self._answers and self._answers_left > 0:
            self._answers_left -= 1
            self._publish(*self._answers.popleft())

    def _publish(self, index: int, value: float | None = None) -> None:
        """Send the present or another value on each channel.

        A slow one gets the then present value with the next tick's bulk data, so that a station that sets
        parameters without end leaves room for telemetry.
        """
        for channel, queue in self._listing.items():
            if self._outbox.is_unlimited(channel):
                self._outbox.send(channel, self._value(index, value))
            elif index not in queue:
                queue.append(index)

    def _value(self, index: int, value: float | None = None) -> Message:
        """PARAM_VALUE with the present or another value."""
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
