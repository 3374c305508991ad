"""How often an address may do something: token buckets, by address and for all strangers together."""

from collections import OrderedDict
from typing import Final, NamedTuple

_MOST_ADDRESSES: Final = 1000


class Rate(NamedTuple):
    """burst: at once; per_s: from then on."""

    burst: int
    per_s: float


class Bucket:
    """A token bucket, full at first."""

    __slots__ = ("_at_s", "_left", "_rate")

    def __init__(self, rate: Rate, now_s: float) -> None:
        self._rate = rate
        self._left = float(rate.burst)
        self._at_s = now_s

    def allows(self, now_s: float) -> bool:
        """Take one token, if there is one."""
        self._left = min(self._left + (now_s - self._at_s) * self._rate.per_s, float(self._rate.burst))
        self._at_s = now_s
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


class Rates:
    """A bucket for each address, and one for all strangers: addresses that have not told the PIN yet.

    So a flood from many addresses does not hold up a skipper.
    """

    def __init__(self, each: Rate, strangers: Rate) -> None:
        self._each = each
        self._buckets: OrderedDict[str, Bucket] = OrderedDict()
        self._strangers = Bucket(strangers, 0.0)

    def allows(self, network: str, now_s: float, *, is_known: bool) -> bool:
        """Count one. network: of the address, by `network_of`; is_known: it has told the PIN."""
        bucket = self._buckets.get(network)
        if bucket is None:
            bucket = self._buckets[network] = Bucket(self._each, now_s)
            if len(self._buckets) > _MOST_ADDRESSES:
                self._buckets.popitem(last=False)
        self._buckets.move_to_end(network)
        return bucket.allows(now_s) and (is_known or self._strangers.allows(now_s))
