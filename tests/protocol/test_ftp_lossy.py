"""Files over a link that loses, delays, doubles and reorders: whole in the end, or not there at all."""

import random
import struct
from pathlib import Path

import pytest
from ftp_client import ACK, STATION, Reply, Served, reply_of, request_of

from companion.mavlink.ftp_frames import Opcode
from sitl.radio.channel import Channel, Quality

TICK_S = 0.02
RETRY_S = 0.3
TRIES = 60  # in a row without an answer; at 40 % loss each way, one in three comes through
LOSSES = [0.05, 0.4]
PATH = b"/files/a.bin"


class Line:
    """A boat at the far end of a bad link, and simulated time."""

    def __init__(self, folder: Path, loss: float, seed: int) -> None:
        quality = Quality(loss=loss, delay_s=0.03, jitter_s=0.05 if loss else 0.0, duplication=loss / 4)
        self.served = Served(folder)
        self.up, self.down = Channel(quality, seed), Channel(quality, seed + 1)
        self.now_s = 0.0
        self.sent = 0
        self.sequence = 0

    def step(self) -> list[Reply]:
        """A tick: what has arrived at the station."""
        self.now_s += TICK_S
        served = self.served
        served.now_s = self.now_s
        for payload in self.up.receive(self.now_s):
            sequence, session, opcode, size, _, _, _, offset = struct.unpack_from("<HBBBBBBI", payload)
            message = request_of(sequence, opcode, payload[12:], session, offset, size)
            served.service.handle(message, STATION, self.now_s)
        served.service.tick(self.now_s)
        for outgoing in served.outbox.drain():
            if outgoing.message.get_type() == "FILE_TRANSFER_PROTOCOL":
                self.down.send(bytes(outgoing.message.payload), self.now_s)
        return [reply_of(payload) for payload in self.down.receive(self.now_s)]

    def post(self, opcode: int, data: bytes, session: int, offset: int, size: int) -> int:
        """Send a request; the number of its answer."""
        self.sequence = (self.sequence + 1) & 0xFFFF
        self.repeat(opcode, data, session, offset, size)
        return (self.sequence + 1) & 0xFFFF

    def repeat(self, opcode: int, data: bytes, session: int, offset: int, size: int) -> None:
        """Send it again under the same number."""
        self.sent += 1
        header = struct.pack("<HBBBBBBI", self.sequence, session, opcode, size or len(data), 0, 0, 0, offset)
        self.up.send(header + data, self.now_s)

    def ask(self, opcode: int, data: bytes = b"", session: int = 0, offset: int = 0, size: int = 0) -> Reply:
        """A request, repeated until it is answered."""
        number = self.post(opcode, data, session, offset, size)
        for _ in range(TRIES):
            until_s = self.now_s + RETRY_S
            while self.now_s < until_s:
                for reply in self.step():
                    if (reply.sequence, reply.request_opcode) == (number, opcode):
                        return reply
            self.repeat(opcode, data, session, offset, size)
        raise AssertionError("no answer")

    def put(self, path: bytes, content: bytes) -> Reply:
        """Upload block by block; the answer to closing."""
        session = self.ask(Opcode.CREATE_FILE, path).session
        for offset in range(0, len(content), 239):
            assert self.ask(Opcode.WRITE_FILE, content[offset : offset + 239], session, offset).opcode == ACK
        return self.ask(Opcode.TERMINATE_SESSION, session=session)


@pytest.mark.parametrize("loss", LOSSES)
@pytest.mark.parametrize("seed", [1, 2])
def test_an_upload_ends_whole(tmp_path: Path, loss: float, seed: int) -> None:
    content = random.Random(seed).randbytes(10_000)
    line = Line(tmp_path, loss, 100 * seed)
    assert line.put(PATH, content).opcode == ACK
    assert (tmp_path / "files" / "a.bin").read_bytes() == content
    for _ in range(500):  # copies that come late change nothing
        line.step()
    assert (tmp_path / "files" / "a.bin").read_bytes() == content


@pytest.mark.parametrize("loss", LOSSES)
def test_what_may_happen_only_once_happens_once(tmp_path: Path, loss: float) -> None:
    line = Line(tmp_path, loss, 5)
    for number in range(8):
        name = b"/files/%d" % number
        assert line.ask(Opcode.CREATE_DIRECTORY, name).opcode == ACK
        assert line.ask(Opcode.RENAME, name + b"\0" + name + b"x").opcode == ACK
        assert line.ask(Opcode.REMOVE_DIRECTORY, name + b"x").opcode == ACK
    assert not list((tmp_path / "files").iterdir())
