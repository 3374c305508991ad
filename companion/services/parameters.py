"""The parameter protocol: list, read, set. Values are C-cast floats, as ArduPilot's are."""

from collections import deque

from companion.mavlink.dialect import Message, dialect
from companion.param_pack import PackError, unpack_upload
from companion.params import Parameters
from companion.services.ftp_frames import Code, Refusal
from companion.services.outbox import Origin, Outbox
from companion.services.statustext import StatusTextService
from companion.vehicle.notice import Notice, Severity

_LIST_PER_TICK = 250  # all there are, where the line is fast; a slow one takes what it has room for
_VALUE_BYTES = 37  # a PARAM_VALUE on the line
_NAMED_REASONS = 3  # of a refused file; the others are only counted


class ParameterService:
    """Answers every request at once; a whole list goes out over the following ticks."""

    def __init__(self, parameters: Parameters, outbox: Outbox, texts: StatusTextService) -> None:
        self._parameters = parameters
        self._outbox = outbox
        self._texts = texts
        self._listing: dict[int, deque[int]] = {}  # by channel: the indexes still to send
        self._left = _LIST_PER_TICK  # how many of all lists may still go out before the next tick

    def on_request_list(self, origin: Origin) -> None:
        """PARAM_REQUEST_LIST: (re)start the list on the channel it came from."""
        self._listing[origin.channel] = deque(range(len(self._parameters.rows)))
        self._go_on(origin.channel)

    def on_request_read(self, message: Message, origin: Origin) -> None:
        """PARAM_REQUEST_READ by index, or by name when the index is −1. What does not exist is not answered:
        the protocol has no refusal."""
        index: int | None = message.param_index
        if message.param_index < 0:
            index = self._parameters.index_of(_name(message.param_id))
        if index is not None and index < len(self._parameters.rows):
            self._outbox.send(origin.channel, self._value(index))

    def on_set(self, message: Message) -> None:
        """PARAM_SET: everyone hears the stored value, also when the change was refused."""
        if reason := self.keep(_name(message.param_id), message.param_value):
            self._texts.tell([Notice(Severity.WARNING, reason)])

    def keep(self, name: str, value: float) -> str:
        """Change one; everyone hears the stored value, and those of other names for the same setting. Returns
        why not, empty when done."""
        reason = self._parameters.set(name, value)
        for index in self._parameters.sharing(name):
            self._outbox.broadcast(self._value(index))
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
        before = self._values()
        self._parameters.reset()
        self._tell_changes(before)

    def take_file(self, file: bytes) -> None:
        """A packed file sets many at once; everyone hears the values that have changed.

        Raises:
            Refusal: it is no such file; nothing has been changed.
        """
        try:
            values = unpack_upload(file)
        except PackError as error:
            self._texts.tell([Notice(Severity.WARNING, f"Parameter file refused: {error}")])
            raise Refusal(Code.FAIL) from None
        before = self._values()
        reasons = self._parameters.set_many(values)
        self._tell_changes(before)
        told = reasons[:_NAMED_REASONS]
        if len(reasons) > len(told):
            told.append(f"{len(reasons) - len(told)} more parameters refused")
        self._texts.tell([Notice(Severity.WARNING, reason) for reason in told])

    def forget(self, channel: int) -> None:
        """A channel has closed."""
        self._listing.pop(channel, None)

    def tick(self) -> None:
        """Go on with the lists under way, and say so when a change could not be kept."""
        if fault := self._parameters.take_fault():
            self._texts.tell([Notice(Severity.ERROR, f"Parameters not stored: {fault}")])
        self._left = _LIST_PER_TICK
        if self._listing:
            for channel in list(self._listing):
                self._go_on(channel)

    def _go_on(self, channel: int) -> None:
        """Send of a list what the line has room for now."""
        queue = self._listing[channel]
        while queue and self._left > 0 and self._outbox.has_room(channel):
            self._left -= 1
            self._outbox.send_bulk(channel, self._value(queue.popleft()), _VALUE_BYTES)
        if not queue:
            del self._listing[channel]

    def _values(self) -> list[float]:
        return [self._parameters.value(row) for row in self._parameters.rows]

    def _tell_changes(self, before: list[float]) -> None:
        for index, (old, new) in enumerate(zip(before, self._values(), strict=True)):
            if new != old:
                self._outbox.broadcast(self._value(index))

    def _value(self, index: int) -> Message:
        row = self._parameters.rows[index]
        return dialect.MAVLink_param_value_message(
            param_id=row.name.encode("ascii"),
            param_value=self._parameters.value(row),
            param_type=int(row.kind),
            param_count=len(self._parameters.rows),
            param_index=index,
        )


def _name(param_id: str | bytes) -> str:
    text = param_id.decode("ascii", errors="replace") if isinstance(param_id, bytes) else param_id
    return text.rstrip("\x00")
