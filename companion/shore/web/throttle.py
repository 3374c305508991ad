"""How long the next try of a PIN waits: doubled with every failure, by address and in total."""

import ipaddress
from collections import OrderedDict
from dataclasses import dataclass
from typing import Final

_FREE: Final = 3  # failures of one address without a wait: a wet finger
_FREE_IN_TOTAL: Final = 10
_MOST_WAIT_S: Final = 900.0
_MOST_WAIT_IN_TOTAL_S: Final = 30.0  # at most 2,880 tries a day, of a million PINs of six digits
_FORGOTTEN_S: Final = 3600.0
_MOST_ADDRESSES: Final = 1000


@dataclass(slots=True)
class _Failures:
    count: int = 0
    last_s: float = float("-inf")

    def wait_s(self, free: int, most_s: float, now_s: float) -> float:
        if self.count < free or now_s - self.last_s > _FORGOTTEN_S:
            return 0.0
        pause_s = min(2.0 ** min(self.count - free, 32), most_s)
        return max(self.last_s + pause_s - now_s, 0.0)

    def add(self, now_s: float) -> None:
        if now_s - self.last_s > _FORGOTTEN_S:
            self.count = 0
        self.count += 1
        self.last_s = now_s


class Throttle:
    """Failures of every address and of all together.

    An address that has told the PIN before is not held up by the failures of others.
    """

    def __init__(self) -> None:
        self._addresses: OrderedDict[str, _Failures] = OrderedDict()
        self._total = _Failures()
        self._known: OrderedDict[str, None] = OrderedDict()

    def wait_s(self, address: str, now_s: float) -> float:
        """Seconds until this address may try; 0: now."""
        network = network_of(address)
        own = self._addresses.get(network, _Failures()).wait_s(_FREE, _MOST_WAIT_S, now_s)
        if network in self._known:
            return own
        return max(own, self._total.wait_s(_FREE_IN_TOTAL, _MOST_WAIT_IN_TOTAL_S, now_s))

    def is_known(self, address: str) -> bool:
        """Whether an address has told the PIN before."""
        return network_of(address) in self._known

    def begin(self, address: str, now_s: float) -> None:
        """Count a try as a failure, before its PIN is checked: tries at the same moment count each other."""
        network = network_of(address)
        self._addresses.setdefault(network, _Failures()).add(now_s)
        self._addresses.move_to_end(network)
        self._total.add(now_s)
        if len(self._addresses) > _MOST_ADDRESSES:
            self._addresses.popitem(last=False)

    def succeed(self, address: str) -> None:
        """Forget the failures of an address whose PIN was right."""
        network = network_of(address)
        own = self._addresses.pop(network, _Failures())
        self._total.count = max(self._total.count - own.count, 0)
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
