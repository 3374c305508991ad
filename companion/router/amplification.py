"""How much may go to an address that might be forged, after RFC 9000, section 8.1.

The source of a datagram is whatever its sender wrote there. A boat that answers every source in full lets
anybody aim its telemetry at a third party. So an address gets three times what came from it, until it has
returned a number that only whoever receives there can know.
"""

import secrets
from typing import NamedTuple

FACTOR = 3  # RFC 9000, section 8.1

# What the announcement and the question take, with signatures: a HEARTBEAT of 34 bytes and a PING of 39.
# Other answers leave them room, or a chatty station would never be asked.
_RESERVE_BYTES = 34 + 39


class Question(NamedTuple):
    """The fields of the PING that the address has to return."""

    time_usec: int
    seq: int


class AmplificationLimit:
    """The account of one address."""

    __slots__ = ("_question", "_sent_bytes")

    def __init__(self) -> None:
        self._sent_bytes = 0
        self._question: Question | None = None

    def question(self, time_usec: int) -> Question:
        """What to ask, the same each time: an answer may be later than the next question."""
        if self._question is None:
            self._question = Question(time_usec, secrets.randbits(32))
        return self._question

    def is_answer(self, answer: Question) -> bool:
        """Whether a PING that has come back is the one that was asked: then the address needs no limit."""
        return answer == self._question

    def spend(self, count: int, heard_bytes: int, *, is_essential: bool) -> bool:
        """Whether so many bytes may go to an address that has sent heard_bytes so far; if so, they count."""
        reserve = 0 if is_essential else _RESERVE_BYTES
        if self._sent_bytes + count + reserve > FACTOR * heard_bytes:
            return False
        self._sent_bytes += count
        return True
