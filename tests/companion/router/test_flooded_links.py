"""What a stranger who floods one link leaves of the others: a whole boat, an operator on a radio."""

from collections import Counter, deque

import pytest
from boat_rig import BOAT, QGC, Peer, Rig

from companion.boat import TICK_S, Boat
from companion.config.boat_config import LinkConfig
from companion.links.interfaces import Port
from companion.links.memory import MemoryPort, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import Message, dialect
from companion.router.policy import ConfiguredPort, Policy

pytestmark = pytest.mark.slow

STRANGER = Address(99, 7)
BAUD = 57_600
BUFFER_BYTES = 8192 + 4096  # the link's queue and the system's
SECONDS = 4


class SlowLine:
    """The boat's end of a line: a buffer that drains at the line's rate into the station's end."""

    name, host, is_datagram, is_closed = "radio", "", False, False

    def __init__(self, bytes_s: float) -> None:
        self._near, self.far = memory_pair("radio", is_datagram=False)
        self._bytes_s = bytes_s
        self._waiting: deque[bytes] = deque()
        self._waiting_bytes = 0
        self._room = 0.0

    def pass_tick(self) -> None:
        """Let the line carry a tick's worth of bytes."""
        self._room += self._bytes_s * TICK_S
        while self._waiting and self._room >= len(self._waiting[0]):
            data = self._waiting.popleft()
            self._room -= len(data)
            self._waiting_bytes -= len(data)
            self._near.send(data)
        if not self._waiting:
            self._room = 0.0

    def receive(self) -> list[bytes]:
        """What the station has sent."""
        return self._near.receive()

    def send(self, data: bytes) -> bool:
        """Put a frame into the buffer; False if it is full."""
        if self._waiting_bytes + len(data) > BUFFER_BYTES:
            return False
        self._waiting.append(data)
        self._waiting_bytes += len(data)
        return True

    def fileno(self) -> int:
        """Nothing to wait on."""
        return -1

    def close(self) -> None:
        """Nothing to let go."""


class FloodedRig(Rig):
    """The operator is on a slow line, the stranger on a link without limits."""

    def __init__(self, policy: Policy, bytes_s: float) -> None:
        self._policy = policy
        self._slow_port = MemoryPort()
        super().__init__()
        self.line = SlowLine(bytes_s)
        self._slow_port.offer(self.line)
        self.receive()
        self.operator = Peer(self.line.far, QGC)
        self.stranger = self.connect(STRANGER)
        self._encoder = Encoder(STRANGER)

    def _build(self) -> Boat:
        ports: list[Port] = [self.port, ConfiguredPort(self._slow_port, self._policy)]
        return Boat(self.config, self.hardware, ports, self.storage)

    def listen_to(
        self, flood: tuple[Message, ...], frames_per_tick: int = 64, seconds: float = SECONDS
    ) -> list[str]:
        """The boat's own messages that the operator hears while it sends a command a second."""
        heard: list[str] = []
        for tick in range(round(seconds / TICK_S)):
            if tick % round(1.0 / TICK_S) == 0:
                self.operator.heartbeat()
                self.operator.command(dialect.MAV_CMD_DO_SET_MODE, 1.0, 4.0)
            for number in range(frames_per_tick if flood else 0):
                self.stranger.link.send(self._encoder.encode(flood[number % len(flood)]))
            self.step()
            self.line.pass_tick()
            heard += [m.get_type() for m in self.operator.listen()]
        return heard


ADDRESSED = dialect.MAVLink_file_transfer_protocol_message(0, *QGC, [0x5A] * 251)
BROADCAST = dialect.MAVLink_encapsulated_data_message(1, [0x5A] * 253)
SETTING = tuple(dialect.MAVLink_param_set_message(*BOAT, b"CRUISE_SPEED", value, 9) for value in (1.5, 1.6))
FLOODS = [((ADDRESSED, BROADCAST), 64), (SETTING, 6)]
LINES = [
    (Policy(LinkConfig(url=""), baud=BAUD), BAUD / 10),
    (Policy(LinkConfig(url="")), 50_000.0),  # a poor Wi-Fi; the boat does not know its rate
]


@pytest.mark.parametrize(
    ("policy", "bytes_s", "flood", "frames_per_tick"),
    [(*LINES[0], *FLOODS[0]), (*LINES[1], *FLOODS[0]), (*LINES[0], *FLOODS[1])],
    ids=["frames on a radio", "frames on a network", "parameters on a radio"],
)
def test_a_flood_on_another_link_displaces_neither_heartbeats_nor_answers(
    policy: Policy, bytes_s: float, flood: tuple[Message, ...], frames_per_tick: int
) -> None:
    rig = FloodedRig(policy, bytes_s)
    calm = Counter(rig.listen_to(()))
    heard = Counter(rig.listen_to(flood, frames_per_tick))
    assert heard["COMMAND_ACK"] >= SECONDS - 1
    assert heard["HEARTBEAT"] >= SECONDS - 1
    for name in ("ATTITUDE", "GLOBAL_POSITION_INT", "SYS_STATUS"):
        assert heard[name] >= 0.9 * calm[name]


def test_a_flood_of_changes_does_not_keep_another_station_from_a_change() -> None:
    rig = FloodedRig(*LINES[0])
    station = rig.connect(Address(254, 190))  # served after the stranger
    rig.listen_to(SETTING, 64, 1.0)
    station.forget()
    station.send(dialect.MAVLink_param_set_message(*BOAT, b"WP_RADIUS", 3.5, 9))
    rig.listen_to(SETTING, 64, 2.0)
    assert ("WP_RADIUS", 3.5) in [(m.param_id, m.param_value) for m in station.said("PARAM_VALUE")]
