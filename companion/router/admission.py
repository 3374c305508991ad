"""What strangers may take: places of a port, and bytes of answers.

Anyone can open a connection or send from an address. Proven links have reserved places that unproven ones
cannot take; unproven ones compete, and the newest is always admitted so that it can prove itself. The link to
close belongs to the host with the most links.
"""

import secrets
from collections import Counter
from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple, Protocol, TypeVar

PLACES = 32  # per port, for proven links, and as many for others
SILENT_S = 10.0  # ten heartbeats: a proven link silent for longer is closed first
_AMPLIFICATION = 3  # RFC 9000, section 8.1
_RESERVE_BYTES = 34 + 39  # signed HEARTBEAT and PING of the verification, reserved against other answers


class Standing(IntEnum):
    """What the far side of a link has proven."""

    STRANGER = 0
    SPEAKING = 1  # sends frames, but no heartbeat, or from a forgeable address
    PROVEN = 2


class Candidate(Protocol):
    """A link, as needed here."""

    @property
    def host(self) -> str:
        """The far side's address."""

    @property
    def standing(self) -> Standing:
        """What it has proven."""

    @property
    def heard_s(self) -> float:
        """Time of the last accepted frame."""


L = TypeVar("L", bound=Candidate)


def excess_links(links: Sequence[L], now_s: float) -> list[L]:
    """The links of a port to close; links are in order of arrival."""
    if len(links) <= PLACES:
        return []
    proven = [link for link in links if link.standing is Standing.PROVEN]
    others = [link for link in links if link.standing is not Standing.PROVEN]
    displaced: list[L] = []
    while len(others) > PLACES:
        rivals = others[:-1]
        lowest = min(link.standing for link in rivals)
        displaced.append(_from_largest_host([link for link in rivals if link.standing is lowest]))
        others.remove(displaced[-1])
    while len(proven) > PLACES:
        silent = min(proven, key=lambda link: link.heard_s)
        is_silent = now_s - silent.heard_s > SILENT_S
        displaced.append(silent if is_silent else _from_largest_host(proven[::-1]))
        proven.remove(displaced[-1])
    return displaced


def _from_largest_host(links: Sequence[L]) -> L:
    """The first link of the host with the most links."""
    host, _ = Counter(link.host for link in links).most_common(1)[0]
    return next(link for link in links if link.host == host)


class Question(NamedTuple):
    """Fields of the PING that must be returned."""

    time_usec: int
    seq: int


class AmplificationLimit:
    """Limit for an address that may be forged, after RFC 9000, section 8.1.

    The source address of a datagram is not verified. A boat that answers every source in full could be used
    to flood a third party. An address therefore gets three times the bytes received from it, until it has
    returned a random number sent to it.
    """

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
        if self._sent_bytes + count + reserve > _AMPLIFICATION * heard_bytes:
            return False
        self._sent_bytes += count
        return True
