"""How much of a 57,600-baud radio does a transfer of a plan use? In simulated time, on the whole boat."""

from collections.abc import Callable

from benchmarks.measure import Row, alone
from companion.boat import TICK_S, Boat
from companion.links.memory import MemoryPort, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import MissionItem, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed
from companion.persistence.storage import MemoryStorage
from sitl.radio.channel import Channel, Quality
from sitl.scenarios.scenario import load_scenario
from sitl.world.world import World

_LINE = Quality(bandwidth_bytes_s=5760.0, backlog_s=5.0)
_BOAT, _STATION = Address(1, 1), Address(245, 190)
_ITEMS = 500
_LIMIT_S = 120.0


def rows() -> list[Row]:
    """Share of one way's room that both ways' traffic takes, for an upload and a download."""
    found: list[Row] = []
    for talks in (False, True):
        how = "with telemetry" if talks else "no telemetry"
        for name, share, seconds in zip(("upload", "download"), *_transfers(talks), strict=True):
            note = f"{_ITEMS} items in {seconds:.1f} s of simulated time; no peer runs in simulated time"
            found.append(alone(f"{name} over 57,600 baud, {how}", "of the line", "more", [share] * 2, note))
    return found


class _Radio:
    """A boat, a station's codec, and a channel each way."""

    def __init__(self) -> None:
        scenario = load_scenario("open", (), None)
        near, self._far = memory_pair("radio")
        self._world = World(scenario)
        self._boat = Boat(scenario.vehicle, self._world.hardware, [MemoryPort(near)], MemoryStorage())
        self._up, self._down = Channel(_LINE, 1), Channel(_LINE, 2)
        self._encoder, self._decoder = Encoder(_STATION), Decoder(datagram=True)
        self.now_s = 0.0
        self.carried = 0

    def send(self, message: Message) -> None:
        """From the station."""
        frame = self._encoder.encode(message)
        self.carried += len(frame)
        self._up.send(frame, self.now_s)

    def run(self, machine: Sender | Receiver, is_over: Callable[[], bool]) -> None:
        """Run until a transfer is over."""
        give_up_s = self.now_s + _LIMIT_S
        while not is_over():
            assert self.now_s < give_up_s, "it never ended"
            for message in machine.take_outbox():
                self.send(message)
            self._pass_time()
            for frame in self._down.receive(self.now_s):
                self.carried += len(frame)
                for received in self._decoder.feed(frame):
                    machine.handle(received.message, received.sender, self.now_s)
            machine.tick(self.now_s)

    def _pass_time(self) -> None:
        """Advance to the next event: an arrival at either end, or a tick of the boat."""
        tick_s = self._world.time_s
        self.now_s = max(self.now_s, min(tick_s, self._up.next_s, self._down.next_s))
        for frame in self._up.receive(self.now_s):
            self._far.send(frame)
            self._boat.receive(self.now_s)
        if self.now_s >= tick_s:
            self._boat.step(tick_s)
            self._world.step(TICK_S)
        for frame in self._far.receive():
            self._down.send(frame, self.now_s)


def _transfers(talks: bool) -> tuple[list[float], list[float]]:
    """Shares and seconds of an upload and a download."""
    radio = _Radio()
    over: list[Completed] = []
    sender = Sender(_STATION, MissionType.MISSION, retry_s=3.0)
    receiver = Receiver(_STATION, MissionType.MISSION, retry_s=3.0)
    if not talks:
        radio.send(dialect.MAVLink_request_data_stream_message(*_BOAT, 0, 1, 0))
    radio.run(sender, lambda: radio.now_s > 5.0)
    items = [MissionItem(3, 16, x=500_000_000 + 50 * n, y=-12_000_000, z=50.0) for n in range(_ITEMS)]
    shares, times = [], []
    for machine in (sender, receiver):
        began_s, before = radio.now_s, radio.carried
        if machine is sender:
            sender.offer(items, _BOAT, radio.now_s)
        else:
            receiver.request_list(_BOAT, radio.now_s)
        over.clear()

        def is_over(machine: Sender | Receiver = machine) -> bool:
            over.extend(event for event in machine.take_events() if isinstance(event, Completed))
            return bool(over)

        radio.run(machine, is_over)
        times.append(radio.now_s - began_s)
        shares.append((radio.carried - before) / (times[-1] * _LINE.bandwidth_bytes_s))
        if machine is receiver:
            receiver.confirm(radio.now_s)
    return shares, times
