"""Refused commands in the program's log: a station gets a number, and not always a message with it."""

import logging

from companion.mavlink.dialect import dialect
from companion.services.commands.command import Command, Result
from companion.services.statustext import StatusTextService

logger = logging.getLogger(__name__)

# Burst and rate limit: a station that repeats its command must not fill the log
_MOST, _PER_SECOND = 20.0, 0.5


class RefusalLog:
    """Logs wherever status texts are logged. dropped: refusals beyond the limit."""

    def __init__(self, texts: StatusTextService) -> None:
        self._texts = texts
        self.dropped = 0
        self._left = _MOST
        self._now_s = 0.0

    def add(self, command: Command, result: Result) -> None:
        """A command was answered."""
        if not self._texts.logs_texts or result in (Result.ACCEPTED, Result.IN_PROGRESS, Result.CANCELLED):
            return
        if self._left < 1.0:
            self.dropped += 1
            return
        self._left -= 1.0
        sender = command.origin.address
        logger.info(
            "%s by %d/%d refused: %s",
            _name("MAV_CMD", command.number),
            sender.system,
            sender.component,
            _name("MAV_RESULT", result),
        )

    def tick(self, now_s: float) -> None:
        self._left = min(self._left + _PER_SECOND * max(now_s - self._now_s, 0.0), _MOST)
        self._now_s = now_s


def _name(enum: str, number: int) -> str:
    entry = dialect.enums[enum].get(number)
    return entry.name.removeprefix(f"{enum}_") if entry is not None else f"{enum} {number}"
