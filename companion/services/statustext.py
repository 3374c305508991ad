"""STATUSTEXT: lines for the operator. Long ones go out in MAVLink 2's chunks of 50 bytes."""

from collections.abc import Callable, Iterable, Iterator

from companion.mavlink.dialect import Message, dialect
from companion.services.outbox import Outbox
from companion.vehicle.notice import Notice

_CHUNK_BYTES = 50


class StatusTextService:
    """Tells every station what the vehicle has to say, and remembers nothing."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._next_id = 1
        self.listener: Callable[[Notice], object] | None = None  # whoever keeps a log

    def tell(self, notices: Iterable[Notice]) -> None:
        """Send lines to everyone."""
        for notice in notices:
            if self.listener is not None:
                self.listener(notice)
            for message in self._chunks(notice):
                self._outbox.broadcast(message)

    def tell_one(self, channel: int, notice: Notice) -> None:
        """Send a line to whoever listens on one channel."""
        for message in self._chunks(notice):
            self._outbox.send(channel, message)

    def _chunks(self, notice: Notice) -> Iterator[Message]:
        raw = notice.text.encode("ascii", errors="replace")
        if len(raw) <= _CHUNK_BYTES:
            yield dialect.MAVLink_statustext_message(notice.severity, raw)
            return
        text_id, self._next_id = self._next_id, self._next_id % 0xFFFF + 1
        for number, start in enumerate(range(0, len(raw), _CHUNK_BYTES)):
            yield dialect.MAVLink_statustext_message(
                notice.severity, raw[start : start + _CHUNK_BYTES], text_id, number
            )
        if len(raw) % _CHUNK_BYTES == 0:  # only a zero byte ends a chunked text
            yield dialect.MAVLink_statustext_message(notice.severity, b"", text_id, len(raw) // _CHUNK_BYTES)
