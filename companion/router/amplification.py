"""Amplification limit for addresses that may be forged, after RFC 9000, section 8.1.

The source address of a datagram is not verified. A boat that answers every source in full could be used to
flood a third party. An address therefore gets three times the bytes received from it, until it has returned a
random number sent to it.
"""

import secrets
from typing import NamedTuple

FACTOR = 3  # RFC 9000, section 8.1

# Signed HEARTBEAT (34 bytes) and PING (39) of the verification, reserved against other answers.
_RESERVE_BYTES = 34 + 39


class Question(NamedTuple):
    """Fields of the PING that must be returned."""

    time_usec: int
    seq: int


class AmplificationLimit:
    """The limit of one address."""

    def __init__(self) -> None:
        self._sent_bytes = 0
        self._question: Question | None = None

    def question(self, time_usec: int) -> Question:
        """The question, constant: an answer may arrive after the next question."""
        if self._question is None:
            self._question = Question(time_usec, secrets.randbits(32))
        return self._question

    def is_answer(self, answer: Question) -> bool:
        """Whether a returned PING is the right one: the limit then ends."""
        return answer == self._question

    def spend(self, count: int, heard_bytes: int, *, is_essential: bool) -> bool:
        """Whether this many bytes may be sent to an address that has sent heard_bytes; if so, they count."""
        reserve = 0 if is_essential else _RESERVE_BYTES
        if self._sent_bytes + count + reserve > FACTOR * heard_bytes:
            return False
        self._sent_bytes += count
        return True
