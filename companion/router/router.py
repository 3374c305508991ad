"""Routing of frames: to the boat's endpoint, to other channels, or nowhere. No I/O, no unpacking.

The rules are those of the MAVLink guide, "Routing": broadcasts and frames without a target go to all other
channels; addressed ones only where their target was heard; nothing goes back to its source.
"""

from collections.abc import Collection
from typing import NamedTuple

from companion.mavlink.address import ALL, Address, concerns
from companion.mavlink.dialect import dialect
from companion.mavlink.framing import Frame
from companion.router.bulk_transfer import DOWNLOAD_IDS, BulkTransferThrottle
from companion.router.duplicate_filter import DuplicateFilter
from companion.router.routes import RouteTable
from companion.router.targets import target_of

_HOUSEKEEPING_S = 1.0
_MAX_DECISIONS = 4096  # remembered; a flood of made-up targets must not fill the memory

# Valid on one link only: radio status, and signing keys
LINK_LOCAL_IDS = frozenset(
    (
        dialect.MAVLINK_MSG_ID_RADIO_STATUS,
        dialect.MAVLINK_MSG_ID_RADIO,
        dialect.MAVLINK_MSG_ID_SETUP_SIGNING,
    )
)


class ForwardingDecision(NamedTuple):
    """is_ours: also for the boat's endpoint. channels: the channels to forward to."""

    is_ours: bool
    channels: tuple[int, ...]
    is_addressed: bool = False


NOWHERE = ForwardingDecision(False, ())


class Router:
    """Knows channels by number. Each received frame is passed to `route` once, in order."""

    def __init__(self, own: Address, components: Collection[int] = ()) -> None:
        """components: further ones of our own."""
        self.repeats = 0  # frames dropped as duplicates
        self.echoes = 0  # our own frames received back
        self.unreachable = 0  # frames for unknown targets
        self.routes = RouteTable()
        self._own = own
        self._ours = frozenset((own, *(Address(own.system, one) for one in components)))
        self._bulk = BulkTransferThrottle()
        self._seen = DuplicateFilter()
        self._forwarding: dict[int, bool] = {}
        self._decisions: dict[tuple[int, Address], ForwardingDecision] = {}
        self._version = -1
        self._housekeeping_s = 0.0

    def open(self, channel: int, forwards: bool = True) -> None:
        """A channel has opened. Without forwarding it only reaches the boat."""
        self._forwarding[channel] = forwards
        self.routes.open(channel)

    def forget(self, channel: int) -> None:
        """A channel has closed."""
        self._forwarding.pop(channel, None)
        self.routes.forget(channel)
        self._bulk.forget(channel)

    def route(self, channel: int, frame: Frame, now_s: float) -> ForwardingDecision:
        """The destinations of a frame."""
        sender = frame.sender
        if sender in self._ours:
            self.echoes += 1
            return NOWHERE
        if now_s >= self._housekeeping_s:
            self._housekeeping_s = now_s + _HOUSEKEEPING_S
            self.routes.expire(now_s)
        self.routes.learn(channel, frame, now_s)
        if len(self._forwarding) > 1 and self._seen.is_duplicate(frame.data, channel, now_s):
            self.repeats += 1
            return NOWHERE
        target = target_of(frame)
        if self._version != self.routes.version or len(self._decisions) >= _MAX_DECISIONS:
            self._version = self.routes.version
            self._decisions.clear()
        way = self._decisions.get((channel, target))
        if way is None:
            way = self._decisions[channel, target] = self._find(channel, target)
        if not (way.is_ours or way.channels):
            self.unreachable += 1
        message_id = frame.message_id
        if message_id in DOWNLOAD_IDS:
            self._bulk.note(frame, target.system, channel, now_s)
            return way._replace(channels=self._bulk.limit(frame, way.channels, now_s))
        if message_id in LINK_LOCAL_IDS:
            return way._replace(channels=())
        return way

    def _find(self, channel: int, target: Address) -> ForwardingDecision:
        is_ours = target in self._ours or concerns(self._own, *target)
        if not self._forwarding[channel] or target in self._ours:
            return ForwardingDecision(is_ours, (), True)
        is_for_all = target.system == ALL
        found = list(self._forwarding) if is_for_all else self.routes.channels_of(target)
        others = tuple(one for one in found if one != channel and self._forwarding[one])
        return ForwardingDecision(is_ours, others, not is_for_all)
