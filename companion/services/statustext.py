"""STATUSTEXT: messages to the operator, long ones in MAVLink 2's chunks of 50 bytes; may be logged."""

import logging
from collections.abc import Callable, Iterable, Iterator

from companion.core.status_text import Severity, StatusText, one_line
from companion.mavlink.dialect import Message, dialect
from companion.services.outbox import Outbox

logger = logging.getLogger(__name__)
# MAVLink's severities are those of syslog
_LEVELS = {Severity.WARNING: logging.WARNING, Severity.NOTICE: logging.INFO, Severity.INFO: logging.INFO}

_CHUNK_BYTES = 50

# Burst and rate limit: refusals must not flood the other messages
_MOST, _PER_SECOND = 40.0, 10.0
_RESERVED = 20.0  # for critical messages


class StatusTextService:
    """Sends status texts to all stations, rate-limited."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._next_id = 1
        self.dropped = 0
        self._left = _MOST
        self.listener: Callable[[StatusText], object] | None = None  # the onboard log
        self.logs_texts = False  # whether messages are also logged

    def notify(self, severity: int, text: str) -> None:
        self.send([StatusText(severity, text)])

    def send(self, status_texts: Iterable[StatusText]) -> None:
        """Send to all; the excess is dropped and counted, the least severe first."""
        for notice in status_texts:
            if self.listener is not None:
                self.listener(notice)
            if self._left < (1.0 if notice.severity <= Severity.CRITICAL else 1.0 + _RESERVED):
                self.dropped += 1
                continue
            self._left -= 1.0
            self._log(notice)
            for message in self._chunks(notice):
                self._outbox.broadcast(message)

    def tick(self, dt_s: float) -> None:
        """Refill the rate limit after dt_s."""
        self._left = min(self._left + _PER_SECOND * dt_s, _MOST)

    def send_to(self, channel: int, notice: StatusText) -> None:
        self._log(notice)
        for message in self._chunks(notice):
            self._outbox.send(channel, message)

    def _log(self, notice: StatusText) -> None:
        if self.logs_texts:
            text = one_line(notice.text)
            logger.log(_LEVELS.get(notice.severity, logging.ERROR), "%s", text)

    def _chunks(self, notice: StatusText) -> Iterator[Message]:
        raw = notice.text.replace("I²C", "I2C").encode("ascii", errors="replace")
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
