"""Which links of one port stay when more come than there are places.

Anybody may open a connection or send from an address, so neither is worth much. Links that have proved
themselves have places of their own, which nobody takes who has not; the others compete among themselves, and
the newest is always let in, so that it can prove itself. Where one must go, it is one of the host that holds
the most.
"""

from collections import Counter
from collections.abc import Sequence
from enum import IntEnum
from typing import Protocol, TypeVar

PLACES = 32  # of one port, for links that have proved themselves, and as many for those that have not
SILENT_S = 10.0  # ten heartbeats: who has proved himself and is silent for longer makes way for another


class Standing(IntEnum):
    """What the far side of a link has shown."""

    STRANGER = 0
    SPEAKING = 1  # says something, but no heartbeat, or from an address that may be forged
    PROVEN = 2


class Candidate(Protocol):
    """A link, as far as it matters here."""

    @property
    def host(self) -> str:
        """The far side's address."""

    @property
    def standing(self) -> Standing:
        """What it has shown so far."""

    @property
    def heard_s(self) -> float:
        """When the last frame was let in."""


L = TypeVar("L", bound=Candidate)


def excess_links(links: Sequence[L], now_s: float) -> list[L]:
    """The links of one port that must go; they are given in the order in which they came."""
    if len(links) <= PLACES:
        return []
    proven = [link for link in links if link.standing is Standing.PROVEN]
    others = [link for link in links if link.standing is not Standing.PROVEN]
    gone: list[L] = []
    while len(others) > PLACES:
        rivals = others[:-1]
        lowest = min(link.standing for link in rivals)
        gone.append(_from_largest_host([link for link in rivals if link.standing is lowest]))
        others.remove(gone[-1])
    while len(proven) > PLACES:
        silent = min(proven, key=lambda link: link.heard_s)
        is_silent = now_s - silent.heard_s > SILENT_S
        gone.append(silent if is_silent else _from_largest_host(proven[::-1]))
        proven.remove(gone[-1])
    return gone


def _from_largest_host(links: Sequence[L]) -> L:
    """The first link of the host that holds the most."""
    host, _ = Counter(link.host for link in links).most_common(1)[0]
    return next(link for link in links if link.host == host)
