"""Lists and files over a radio of 57,600 baud: they use the line, and telemetry goes on beside them."""

import struct

from boat_rig import Peer, Rig

from companion.config.boat_config import LinkConfig
from companion.links.memory import MemoryPort, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.ftp_frames import Opcode
from companion.router.policy import ConfiguredPort, Policy

LINE_BYTES_S = 5760.0
SAVED_S = 0.2  # what a line that was idle takes at once, as the time it stands for
LEAST_SHARE = 0.7  # of what the line carries


class Radio:
    """A boat and a station, each at an end of a radio."""

    def __init__(self) -> None:
        self.rig = Rig()
        near, far = memory_pair("radio", is_datagram=False)
        policy = Policy(LinkConfig(url="radio", radio=True, max_bytes_s=LINE_BYTES_S))
        self.rig.boat.channels._ports.append(ConfiguredPort(MemoryPort(near), policy))
        self.peer = Peer(far, Address(254, 190))
        self.rig.run(1.0)
        self.peer.forget()
        (self.channel,) = [one for one in self.rig.boat.channels.open.values() if one.policy is policy]

    def share_until(self, name: str, count: int, limit_s: float) -> tuple[float, list[Message]]:
        """Run until so many messages have come: how much of the line was used, and what has come."""
        before = self.channel.counters.bytes_out
        seconds = self.rig.until(lambda: len(self.peer.said(name)) >= count, limit_s)
        return (self.channel.counters.bytes_out - before) / (
            SAVED_S + seconds
        ) / LINE_BYTES_S, self.peer.heard

    def ask(self, sequence: int, opcode: int, data: bytes = b"", size: int = 0) -> None:
        header = struct.pack("<HBBBBBBI", sequence, 0, opcode, len(data) or size, 0, 0, 0, 0)
        payload = (header + data).ljust(251, b"\0")
        self.peer.send(dialect.MAVLink_file_transfer_protocol_message(0, 1, 1, payload))


def test_a_file_takes_its_share_and_leaves_room_for_telemetry() -> None:
    radio = Radio()
    radio.ask(1, Opcode.OPEN_FILE_RO, b"/metadata/parameters.json.xz")
    radio.rig.step(3)
    (opened,) = radio.peer.said("FILE_TRANSFER_PROTOCOL")
    blocks = -(-struct.unpack_from("<I", bytes(opened.payload), 12)[0] // 239)
    radio.peer.forget()
    radio.ask(2, Opcode.BURST_READ_FILE, size=239)
    share, heard = radio.share_until("FILE_TRANSFER_PROTOCOL", blocks + 1, 12.0)
    assert LEAST_SHARE < share <= 1.05
    assert {"ATTITUDE", "GLOBAL_POSITION_INT", "HEARTBEAT"} <= {one.get_type() for one in heard}
    assert radio.channel.queue.dropped == 0
