"""Sender against receiver over a seeded bad link, both ways round.

The invariant: it ends; success means that both sides hold the same; failure means the old list or the new
one, whole.
"""

from dataclasses import dataclass, field

from hypothesis import given, settings
from hypothesis import strategies as st

from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.items import MissionItem, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed, Event, Failed, TransferState
from sitl.radio.channel import Channel, Quality

BOAT, STATION = Address(1, 1), Address(255, 190)
TICK_S = 0.02
PATIENCE_S = 3600.0

OLD = tuple(MissionItem(3, 16, x=n, y=-n) for n in range(4))


def new_list(count: int) -> tuple[MissionItem, ...]:
    return tuple(
        MissionItem(3, 16, param1=n + 0.5, param4=float("nan"), x=1000 + n, y=n) for n in range(count)
    )


@dataclass(slots=True)
class End:
    """One side: a machine, its codec, and what it has heard of."""

    machine: Sender | Receiver
    encoder: Encoder
    decoder: Decoder
    out: Channel
    store: tuple[MissionItem, ...] = ()
    events: list[Event] = field(default_factory=list)

    def step(self, incoming: list[bytes], now_s: float) -> None:
        for data in incoming:
            for message, sender, _ in self.decoder.feed(data):
                self.machine.handle(message, sender, now_s)
                self.settle(now_s)
        self.machine.tick(now_s)
        self.settle(now_s)

    def settle(self, now_s: float) -> None:
        for event in self.machine.take_events():
            self.events.append(event)
            if isinstance(event, Completed) and isinstance(self.machine, Receiver):
                self.store = event.items
                self.machine.confirm(now_s)
        for message in self.machine.take_outbox():
            self.out.send(self.encoder.encode(message), now_s)

    @property
    def verdict(self) -> Completed | Failed | None:
        return next((e for e in reversed(self.events) if isinstance(e, Completed | Failed)), None)


class Pair:
    """A sender and a receiver with a channel each way."""

    def __init__(
        self,
        mission_type: MissionType,
        quality: Quality,
        seed: int,
        boat_receives: bool,
        source: tuple[MissionItem, ...] | None,
        retries: int = 10,
    ) -> None:
        sender_address, receiver_address = (STATION, BOAT) if boat_receives else (BOAT, STATION)
        sender = Sender(
            sender_address, mission_type, retries=retries, source=None if source is None else lambda: source
        )
        receiver = Receiver(receiver_address, mission_type, retries=retries)
        self.sender = End(sender, Encoder(sender_address), Decoder(True), Channel(quality, seed))
        self.receiver = End(
            receiver, Encoder(receiver_address), Decoder(True), Channel(quality, seed + 1), OLD
        )
        self.now_s = 0.0

    def step(self) -> None:
        to_receiver = self.sender.out.receive(self.now_s)
        to_sender = self.receiver.out.receive(self.now_s)
        self.receiver.step(to_receiver, self.now_s)
        self.sender.step(to_sender, self.now_s)
        self.now_s += TICK_S

    def run(self) -> None:
        """Until both have forgotten the transfer and the channels are empty."""
        while not (
            self.sender.machine.state is TransferState.IDLE
            and self.receiver.machine.state is TransferState.IDLE
            and self.sender.out.is_empty
            and self.receiver.out.is_empty
        ):
            self.step()
            assert self.now_s < PATIENCE_S, "it never ends"


def upload(
    mission_type: MissionType, items: tuple[MissionItem, ...], quality: Quality, seed: int, retries: int = 10
) -> Pair:
    pair = Pair(mission_type, quality, seed, True, None, retries)
    assert isinstance(pair.sender.machine, Sender)
    pair.sender.machine.offer(items, BOAT, 0.0)
    pair.sender.settle(0.0)
    pair.run()
    return pair


def download(
    mission_type: MissionType, items: tuple[MissionItem, ...], quality: Quality, seed: int, retries: int = 10
) -> Pair:
    pair = Pair(mission_type, quality, seed, False, items, retries)
    assert isinstance(pair.receiver.machine, Receiver)
    pair.receiver.machine.request_list(BOAT, 0.0)
    pair.receiver.settle(0.0)
    pair.run()
    return pair


def assert_whole(pair: Pair, items: tuple[MissionItem, ...]) -> None:
    assert pair.receiver.store in (OLD, items)
    verdict = pair.sender.verdict
    assert verdict is not None
    if isinstance(verdict, Completed):
        assert verdict.items == items
        assert pair.receiver.store == items
    completed = [e for e in pair.receiver.events if isinstance(e, Completed)]
    assert (pair.receiver.store == items and bool(completed)) or (
        pair.receiver.store == OLD and not completed
    )


qualities = st.builds(
    Quality,
    loss=st.floats(0.0, 0.4),
    delay_s=st.floats(0.0, 0.3),
    jitter_s=st.floats(0.0, 0.3),
    duplication=st.floats(0.0, 0.3),
)


@settings(max_examples=40)
@given(st.sampled_from(MissionType), st.integers(0, 12), qualities, st.integers(0, 2**32))
def test_an_upload_ends_and_leaves_the_old_or_the_new_list_whole(
    mission_type: MissionType, count: int, quality: Quality, seed: int
) -> None:
    items = new_list(count)
    assert_whole(upload(mission_type, items, quality, seed), items)


@settings(max_examples=40)
@given(st.sampled_from(MissionType), st.integers(0, 12), qualities, st.integers(0, 2**32))
def test_a_download_ends_and_leaves_the_old_or_the_new_list_whole(
    mission_type: MissionType, count: int, quality: Quality, seed: int
) -> None:
    items = new_list(count)
    pair = download(mission_type, items, quality, seed)
    assert pair.receiver.store in (OLD, items)
    assert (pair.receiver.store == items) == isinstance(pair.receiver.verdict, Completed)


@settings(max_examples=25)
@given(st.lists(st.integers(0, 6), min_size=2, max_size=4), qualities, st.integers(0, 2**32))
def test_uploads_one_after_the_other_each_leave_a_whole_list(
    counts: list[int], quality: Quality, seed: int
) -> None:
    pair = Pair(MissionType.MISSION, quality, seed, boat_receives=True, source=None)
    assert isinstance(pair.sender.machine, Sender)
    before = OLD
    for round_number, count in enumerate(counts):
        items = tuple(MissionItem(3, 16, x=100 * round_number + n) for n in range(count))
        pair.sender.machine.offer(items, BOAT, pair.now_s)
        pair.sender.settle(pair.now_s)
        pair.run()
        assert pair.receiver.store in (before, items)
        if isinstance(pair.sender.verdict, Completed):
            assert pair.receiver.store == items
        before = pair.receiver.store
