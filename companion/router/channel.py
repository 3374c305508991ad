"""A link with its framing, rules, rate limit and counters."""

import logging
import struct
from collections import deque
from collections.abc import Callable, Collection, Sequence

from companion.links.interfaces import Link
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.finder import Counters, FrameFinder
from companion.mavlink.framing import MAGIC_V2, SIGNATURE_LENGTH, Frame, message_id_of
from companion.mavlink.signing import SigningGuard, is_signed, loggable
from companion.mavlink.signing_key import SigningKey
from companion.router.admission import AmplificationLimit, Question, Standing
from companion.router.policy import PLAIN, Filter, Policy
from companion.router.tx_queue import LineBudget, TxQueue

logger = logging.getLogger(__name__)

_HEARTBEAT: int = dialect.MAVLINK_MSG_ID_HEARTBEAT
_ESSENTIAL_IDS = (_HEARTBEAT, dialect.MAVLINK_MSG_ID_PING)  # by which a forgeable address proves itself
_RADIO_STATUS_IDS = (dialect.MAVLINK_MSG_ID_RADIO_STATUS, dialect.MAVLINK_MSG_ID_RADIO)
_UNLIMITED_BYTES = 1 << 30
_TICK_S = 0.02
_FREE_PERCENT_AT = 6  # txbuf, behind two counters of errors and two signal strengths


class Channel:
    """One link. queue: of what waits for it. tap, set by the telemetry log, receives every frame in and out,
    without signatures and keys.
    """

    def __init__(
        self,
        number: int,
        link: Link,
        own: Address,
        policy: Policy = PLAIN,
        components: Collection[int] = (),
    ) -> None:
        """components: further senders of our own, besides `own`."""
        self.number = number
        self.link = link
        self.policy = policy
        self.counters = Counters()
        self.encoder = Encoder(own, self.counters)
        self._encoders = {one: Encoder(Address(own.system, one), self.counters) for one in components}
        self.guard: SigningGuard | None = None
        self.tap: Callable[[bytes], object] | None = None
        self.forwarded = 0  # of other channels' frames, sent by this one
        self.withheld = 0  # by allow, deny and rate caps, and for unverified peers
        self.refused = 0  # by the guard, in or out
        self.faults = 0  # messages that could not be packed: our defects, see the log
        self.is_blocked = False  # too much garbage: not read before the next tick
        self.is_noisy = False  # garbage when last read
        self.wasted_before = 0  # wasted checks up to the last tick
        self.heard_s = float("-inf")  # time of the last accepted frame
        self._has_announced_itself = False  # by a heartbeat
        self._is_confidential = False  # requires signatures and has received none: only heartbeats are sent
        self._limit = AmplificationLimit() if policy.is_forgeable(link.host) else None
        self._own = frozenset(bytes((own.system, one)) for one in (own.component, *components))
        self._finder = FrameFinder(link.is_datagram, self.counters)
        self._chunks: deque[bytes] = deque()
        self._filter = Filter(policy)
        self._budget = LineBudget(policy.bytes_s) if policy.bytes_s else None
        self.queue = TxQueue(self._transmit, self._budget, policy.stale_s)

    def set_guard(self, guard: SigningGuard) -> None:
        """Sign and check frames."""
        self.guard = guard
        self._is_confidential = guard.policy == "required" and not guard.has_verified
        self.queue.overhead_bytes = SIGNATURE_LENGTH

    def has_verified(self, frame: Frame, key: SigningKey | None) -> bool:
        """Whether an accepted frame bears a valid signature under this key."""
        return self.guard is not None and self.guard.verifies_with(key) and is_signed(frame.data)

    @property
    def host(self) -> str:
        """Address of the far side, empty if there is none."""
        return self.link.host

    @property
    def standing(self) -> Standing:
        """What the far side has proven: a valid signature, or on an open link a heartbeat."""
        if self.guard is not None and self.guard.has_verified:
            return Standing.PROVEN
        if self._is_confidential or self.heard_s < 0.0:
            return Standing.STRANGER
        is_proven = self._has_announced_itself and self._limit is None
        return Standing.PROVEN if is_proven else Standing.SPEAKING

    @property
    def needs_address_proof(self) -> bool:
        """Whether output is limited until a question is answered, as the address may be forged."""
        return self._limit is not None and not self._is_confidential

    def question(self, time_usec: int) -> Question | None:
        """The question to ask; None if the address is verified."""
        return self._limit.question(time_usec) if self._limit is not None else None

    def check_answer(self, answer: Question) -> None:
        """Check a returned PING; the right one verifies the address."""
        if self._limit is not None and self._limit.is_answer(answer):
            self._limit = None

    @property
    def has_more(self) -> bool:
        """Whether received bytes are left after `receive`."""
        return bool(self._chunks) or self._finder.is_behind

    @property
    def wasted_checks(self) -> int:
        """Cost of garbage since the link opened, see `FrameFinder`."""
        return self._finder.wasted_checks

    def poll(self) -> bool:
        """Read the link, unless something is left; whether there is anything to `receive`."""
        if self._chunks or self._finder.is_behind:
            return True
        arrived = self.link.receive()
        self._chunks.extend(arrived)
        return bool(arrived)

    def receive(self, most_frames: int, most_wasted_looks: int) -> Sequence[Frame]:
        """The next received frames, within the limits. The rest is kept, and no more is read."""
        if not self.poll():
            return ()
        chunks, finder = self._chunks, self._finder
        last_look = finder.wasted_checks + most_wasted_looks
        taken: list[Frame] = []
        while finder.is_behind or chunks:
            if len(taken) >= most_frames or finder.wasted_checks >= last_look:
                break
            if not finder.is_behind:
                finder.put(chunks.popleft())
            taken += finder.find(most_frames - len(taken), last_look - finder.wasted_checks)
        return taken

    def accepts(self, frame: Frame, now_s: float = 0.0) -> bool:
        """Whether a frame is accepted; it is then logged, and a radio's report is used."""
        guard = self.guard
        if guard is not None:
            if not guard.admits(frame.data):
                self.refused += 1
                return False
            if guard.has_verified:  # sent by a holder of the key, and not replayed
                self._is_confidential, self._limit = False, None
        self.heard_s = now_s
        if frame.message_id == _HEARTBEAT:
            self._has_announced_itself = True
        if self.tap is not None and (logged := loggable(frame.data)):
            self.tap(logged)
        if self._budget is not None and frame.message_id in _RADIO_STATUS_IDS:
            payload = frame.payload
            self._budget.on_radio_status(payload[_FREE_PERCENT_AT] if len(payload) > _FREE_PERCENT_AT else 0)
        return True

    def may_send(self, now_s: float) -> bool:
        """Whether telemetry would be sent at once."""
        if self._is_confidential or self._limit is not None:
            return False
        return self.queue.may_send(now_s)

    def room_bytes(self, now_s: float) -> int:
        """Bulk data that may be sent now: with a rate limit, that of a tick."""
        if not self.may_send(now_s):
            return 0
        return _UNLIMITED_BYTES if self._budget is None else 1 + int(self.policy.bytes_s * _TICK_S)

    def send(self, message: Message, now_s: float = 0.0, component: int = 0) -> None:
        """Send a message of our own, or drop it whole. Never raises. component: the sender; 0: `own`."""
        try:
            data = self._encoders.get(component, self.encoder).encode(message)
        except (struct.error, OverflowError, TypeError, ValueError):
            self.faults += 1
            if self.faults == 1:
                logger.exception("%s: %s cannot be packed", self.link.name, message.get_type())
            return
        if self._may_leave(message.get_msgId(), self.encoder.address.system, now_s):
            self.queue.put(data, now_s)

    def forward(self, frame: Frame, source: "Channel", is_addressed: bool, now_s: float) -> None:
        """Send a frame of another channel unchanged, or drop it whole.

        A link that requires signatures gets only what is signed with its key.
        """
        guard = self.guard
        if guard is not None and guard.policy == "required" and not source.has_verified(frame, guard.key):
            self.withheld += 1
            return
        counters = self.counters
        self.forwarded += 1
        counters.frames_out += 1
        counters.bytes_out += len(frame.data)
        if self._may_leave(frame.message_id, frame.sender.system, now_s):
            self.queue.forward(frame.data, source.number, is_addressed, now_s)

    def drain(self, now_s: float) -> None:
        """Send waiting frames."""
        self.queue.drain(now_s)

    def _may_leave(self, message_id: int, system: int, now_s: float) -> bool:
        is_silent = self._is_confidential and message_id != _HEARTBEAT
        if is_silent or not self._filter.passes(message_id, system, now_s):
            self.withheld += 1
            return False
        return True

    def _transmit(self, data: bytes) -> bool:
        """Put a frame on the link; False if it is full.

        Our own are signed here, as a frame that has waited needs a new timestamp. Forwarded ones are
        unchanged: a signature would vouch for them.
        """
        frame = data
        if self.guard is not None and data[0] == MAGIC_V2 and bytes(data[5:7]) in self._own:
            sealed = self.guard.seal(data)
            if sealed is None:
                self.refused += 1
                return True
            frame = sealed
        if self._limit is not None and not self._may_spend(self._limit, frame):
            self.withheld += 1
            return True
        if not self.link.send(frame):
            return False
        if self.tap is not None and (logged := loggable(data)):
            self.tap(logged)
        return True

    def _may_spend(self, limit: AmplificationLimit, frame: bytes) -> bool:
        counters = self.counters
        heard_bytes = counters.bytes_in if counters.frames_in else 0
        return limit.spend(len(frame), heard_bytes, is_essential=message_id_of(frame) in _ESSENTIAL_IDS)
