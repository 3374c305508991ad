"""Whose PIN is looked at next, and how long the next try of an address waits.

Theory of operation
-------------------
An address waits twice as long after each wrong PIN. The failures of others never refuse it: its try is looked
at in turn, and whoever has failed less often has its turn first. The more wrong PINs there were in all, the
slower the turns come, to one in MOST_PACE_S. So a new phone waits for the addresses that have not failed yet,
and no longer. An address gets some 100 tries a day, a network of 254 of them 25,000: of six digits 2.5 %.
"""

import ipaddress
from collections import OrderedDict
from dataclasses import dataclass
from typing import Final

_FREE: Final = 3  # failures of one address without a wait: a wet finger
_FREE_IN_TOTAL: Final = 10
_MOST_WAIT_S: Final = 900.0
_PACE_STEP_S: Final = 0.05  # for each failure in total
MOST_PACE_S: Final = 1.0  # a check takes 0.3 s on a Pi Zero 2
_FORGOTTEN_S: Final = 86_400.0
_FORGOTTEN_IN_TOTAL_S: Final = 3600.0
_MOST_ADDRESSES: Final = 1000


@dataclass(slots=True)
class _Failures:
    forgotten_s: float
    count: int = 0
    last_s: float = float("-inf")

    def at(self, now_s: float) -> int:
        return 0 if now_s - self.last_s > self.forgotten_s else self.count

    def add(self, now_s: float) -> None:
        self.count = self.at(now_s) + 1
        self.last_s = now_s


class Throttle:
    """Failures of every address, and of all together."""

    def __init__(self) -> None:
        self._addresses: OrderedDict[str, _Failures] = OrderedDict()
        self._total = _Failures(_FORGOTTEN_IN_TOTAL_S)
        self._known: OrderedDict[str, None] = OrderedDict()

    def wait_s(self, address: str, now_s: float) -> float:
        """Seconds until this address may try; 0: now."""
        own = self._addresses.get(network_of(address))
        if own is None or own.at(now_s) < _FREE:
            return 0.0
        pause_s = min(2.0 ** min(own.count - _FREE, 32), _MOST_WAIT_S)
        return max(own.last_s + pause_s - now_s, 0.0)

    def rank(self, address: str, now_s: float) -> int:
        """The lowest rank has its turn first: one that has told the PIN before, then by its failures."""
        own = self._addresses.get(network_of(address))
        return -1 if self.is_known(address) else 0 if own is None else own.at(now_s)

    def pace_s(self, now_s: float) -> float:
        """Seconds from one look at a PIN to the next."""
        return min(_PACE_STEP_S * max(self._total.at(now_s) - _FREE_IN_TOTAL, 0), MOST_PACE_S)

    def is_known(self, address: str) -> bool:
        """Whether an address has told the PIN before."""
        return network_of(address) in self._known

    def begin(self, address: str, now_s: float) -> None:
        """Count a try as a failure, before its PIN is checked: tries at the same moment count each other."""
        network = network_of(address)
        self._addresses.setdefault(network, _Failures(_FORGOTTEN_S)).add(now_s)
        self._addresses.move_to_end(network)
        if len(self._addresses) > _MOST_ADDRESSES:
            self._addresses.popitem(last=False)

    def fail(self, now_s: float) -> None:
        """A PIN was looked at, and wrong."""
        self._total.add(now_s)

    def succeed(self, address: str) -> None:
        """Forget the failures of an address whose PIN was right."""
        network = network_of(address)
        self._addresses.pop(network, None)
        self._known[network] = None
        if len(self._known) > _MOST_ADDRESSES:
            self._known.popitem(last=False)


def network_of(address: str) -> str:
    """The address; of IPv6 its /64, of which one computer may use every address."""
    try:
        parsed = ipaddress.ip_address(address.partition("%")[0])
    except ValueError:
        return address
    if isinstance(parsed, ipaddress.IPv4Address):
        return str(parsed)
    if parsed.ipv4_mapped is not None:
        return str(parsed.ipv4_mapped)
    return str(ipaddress.IPv6Network((parsed, 64), strict=False))
