"""Routing of frames: to the boat's endpoint, to other channels, or nowhere. No I/O, no unpacking.

The rules are those of the MAVLink guide, "Routing": broadcasts and frames without a target go to all other
channels; addressed ones only where their target was heard; nothing goes back to its source.
"""

import math
from collections.abc import Collection
from typing import NamedTuple

from companion.mavlink.address import ALL, Address, concerns
from companion.mavlink.dialect import dialect
from companion.mavlink.framing import Frame
from companion.router.routes import RouteTable, target_of

_HOUSEKEEPING_S = 1.0
_MAX_DECISIONS = 4096  # remembered; a flood of made-up targets must not fill the memory

# Valid on one link only: radio status, and signing keys
LINK_LOCAL_IDS = {
    dialect.MAVLINK_MSG_ID_RADIO_STATUS, dialect.MAVLINK_MSG_ID_RADIO, dialect.MAVLINK_MSG_ID_SETUP_SIGNING,
}  # fmt: skip

_REQUEST_LIFE_S = 60.0  # of a download; further requests renew it
_LOG_REQUESTS = {dialect.MAVLINK_MSG_ID_LOG_REQUEST_LIST, dialect.MAVLINK_MSG_ID_LOG_REQUEST_DATA}
_LOG_REPLIES = {dialect.MAVLINK_MSG_ID_LOG_ENTRY, dialect.MAVLINK_MSG_ID_LOG_DATA}
_FTP = dialect.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL
_FTP_OPCODE_AT = 6  # after network, system, component, sequence and session
_FTP_FIRST_REPLY: int = dialect.MAV_FTP_OPCODE_ACK
_DOWNLOAD_IDS = _LOG_REQUESTS | _LOG_REPLIES | {_FTP}


class DuplicateFilter:
    """Detects frames received again on another link: two radios to one station, or a network loop.

    Frames are remembered for half to one window, less during a flood. Repeats on the same link are none.
    """

    def __init__(self, window_s: float = 0.5, max_frames: int = 4096) -> None:
        self._half_s = 0.5 * window_s
        self._half_frames = max_frames // 2
        self._recent: dict[bytes, int] = {}
        self._older: dict[bytes, int] = {}
        self._turn_s = 0.0

    def is_duplicate(self, data: bytes, channel: int, now_s: float) -> bool:
        """Whether another channel has brought this frame within the window; otherwise it is remembered."""
        recent = self._recent
        if now_s >= self._turn_s or len(recent) >= self._half_frames:
            self._turn(now_s)
            recent = self._recent
        first = recent.get(data)
        if first is None:
            first = self._older.get(data)
            if first is None or first == channel:
                recent[data] = channel
                return False
        return first != channel

    def _turn(self, now_s: float) -> None:
        # after a long silence both halves are outdated
        is_overdue = now_s >= self._turn_s + self._half_s
        self._older = {} if is_overdue else self._recent
        self._recent = {}
        # from the due time, so that a late turn does not extend the window
        is_due = now_s >= self._turn_s and not is_overdue
        self._turn_s = (self._turn_s if is_due else now_s) + self._half_s


class BulkTransferThrottle:
    """Limits log and file transfers to the links that requested them.

    LOG_ENTRY and LOG_DATA have no target and would go out on every link; file replies are addressed, but a
    station on several links needs them once.
    """

    def __init__(self) -> None:
        self._asked_s: dict[tuple[bool, int, int], float] = {}  # by is_file, system, channel

    def note(self, frame: Frame, target_system: int, channel: int, now_s: float) -> None:
        """Record a request in a received frame."""
        if frame.message_id in _LOG_REQUESTS or _is_file_request(frame):
            self._asked_s[frame.message_id == _FTP, target_system, channel] = now_s

    def limit(self, frame: Frame, channels: tuple[int, ...], now_s: float) -> tuple[int, ...]:
        """The channels to which a frame may go."""
        is_file = frame.message_id == _FTP
        if frame.message_id not in _LOG_REPLIES and not (is_file and not _is_file_request(frame)):
            return channels
        system = frame.sender.system
        return tuple(
            channel
            for channel in channels
            if now_s - self._asked_s.get((is_file, system, channel), -math.inf) < _REQUEST_LIFE_S
        )

    def forget(self, channel: int) -> None:
        """A channel has closed."""
        self._asked_s = {key: at_s for key, at_s in self._asked_s.items() if key[2] != channel}


def _is_file_request(frame: Frame) -> bool:
    if frame.message_id != _FTP:
        return False
    payload = frame.payload
    return (payload[_FTP_OPCODE_AT] if len(payload) > _FTP_OPCODE_AT else 0) < _FTP_FIRST_REPLY


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
        if message_id in _DOWNLOAD_IDS:
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
