"""The station reads files of the boat's own service over links that lose, delay, double and reorder.

And of boats that lie. It always ends, and a success has the same bytes.
"""

import random
import struct
from pathlib import Path

import pytest
from ftp_client import ACK, BOAT, STATION, Reply, Served, reply_of
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.mavlink.dialect import Message, dialect
from companion.mavlink.ftp_frames import Code, Opcode
from mission_tools.station.ftp.blocks import WINDOW_BYTES
from mission_tools.station.ftp.client import FtpClient
from mission_tools.station.ftp.jobs import FtpFailure
from mission_tools.station.ftp.reading import Reading
from mission_tools.station.words import say
from sitl.radio.channel import Channel, Quality

TICK_S = 0.02
PATH = "logs/00001.bin"
MOST_BYTES = 10_000_000


def message_of(payload: bytes) -> Message:
    own = STATION.address
    message: Message = dialect.MAVLink_file_transfer_protocol_message(0, own.system, own.component, payload)
    return message


class Bin:
    """A sink of a test. room: fixed, or None for as much as may come."""

    def __init__(self, rooms: int | None = None) -> None:
        self.content = b""
        self.sizes: list[int] = []
        self.rooms = rooms

    def begin(self, size: int) -> None:
        self.sizes.append(size)
        self.content = b""

    def write(self, data: bytes) -> None:
        self.content += data
        if self.rooms is not None:
            self.rooms -= len(data)
            assert self.rooms >= 0, "more was written than there was room for"

    def room(self) -> int:
        return WINDOW_BYTES if self.rooms is None else self.rooms


class Line:
    """The client, the boat's service, and a bad link between them, in simulated time."""

    def __init__(self, folder: Path, quality: Quality, seed: int) -> None:
        self.folder = folder
        self.served = Served(folder)
        self.up, self.down = Channel(quality, seed), Channel(quality, seed + 1)
        self.now_s = 0.0
        self.requests = 0
        self.client = FtpClient(BOAT, STATION.address, self._send)
        self.ended: list[object] = []
        self.arrived: list[bytes] = []
        self.sequence = 0

    def _send(self, message: Message) -> None:
        self.requests += 1
        self.up.send(bytes(message.payload), self.now_s)

    def reboot(self) -> None:
        self.served = Served(self.folder)

    def step(self) -> None:
        self.now_s += TICK_S
        served = self.served
        served.now_s = self.now_s
        for payload in self.up.receive(self.now_s):
            request = dialect.MAVLink_file_transfer_protocol_message(0, *BOAT, payload)
            served.service.handle(request, STATION, self.now_s)
        served.service.tick(self.now_s)
        for outgoing in served.outbox.drain():
            if outgoing.message.get_type() == "FILE_TRANSFER_PROTOCOL":
                self.down.send(bytes(outgoing.message.payload), self.now_s)
        self.arrived = self.down.receive(self.now_s)
        for payload in self.arrived:
            self.client.handle(message_of(payload), self.now_s)
        self.client.poll(self.now_s)

    def until_ended(self, count: int = 1, limit_s: float = 300.0) -> None:
        until_s = self.now_s + limit_s
        while len(self.ended) < count:
            assert self.now_s < until_s, "the transfer does not end"
            self.step()

    def read(self, sink: Bin, path: str = PATH, *, grows: bool = True) -> Reading:
        return self.client.read(path, sink, self.ended.append, most_bytes=MOST_BYTES, grows=grows)

    def ask(self, opcode: int, data: bytes = b"", session: int = 0, offset: int = 0) -> Reply:
        """A request of the test's own, repeated under its number until it is answered."""
        self.sequence += 1
        header = struct.pack("<HBBBBBBI", self.sequence, session, opcode, len(data), 0, 0, 0, offset)
        for tick in range(1000):
            if tick % 15 == 0:
                self.up.send(header + data, self.now_s)
            self.step()
            for reply in map(reply_of, self.arrived):
                if (reply.sequence, reply.request_opcode) == (self.sequence + 1, opcode):
                    return reply
        raise AssertionError("no answer")


def put_log(folder: Path, size: int, seed: int = 3, name: str = "00001.bin") -> bytes:
    content = random.Random(seed).randbytes(size)
    (folder / "logs").mkdir(exist_ok=True)
    (folder / "logs" / name).write_bytes(content)
    return content


def bad(loss: float) -> Quality:
    jitter_s = 0.05 if loss else 0.0
    return Quality(loss=loss, delay_s=0.03, jitter_s=jitter_s, duplication=loss / 4, reordering=loss / 2)


@pytest.mark.parametrize("loss", [0.0, 0.2, 0.4])
def test_a_log_arrives_whole_over_a_bad_link(tmp_path: Path, loss: float) -> None:
    content = put_log(tmp_path, 200_000)
    line, sink = Line(tmp_path, bad(loss), 100), Bin()
    line.read(sink)
    line.until_ended()
    assert line.ended == [None]
    assert sink.content == content
    assert sink.sizes == [len(content)]
    print(f"200 kB at {loss:.0%} loss: {line.now_s:.1f} s, {line.requests} requests")  # noqa: T201
    if loss == 0.0:
        assert line.now_s < 1.5
    for _ in range(300):
        line.step()
    assert not any(station.sessions for station in line.served.service._stations)
    assert not line.client.is_busy


@pytest.mark.parametrize(
    ("grows", "seed", "sizes", "end"),
    [
        (True, 3, [300_000], None),  # it goes on, it does not begin anew
        (True, 4, [300_000], FtpFailure(say("file.other"))),
        (False, 4, [300_000, 300_000], None),
    ],
    ids=["same log", "another log", "a file that may change"],
)
def test_a_restart_of_the_boat_in_mid_transfer(
    tmp_path: Path, grows: bool, seed: int, sizes: list[int], end: object
) -> None:
    put_log(tmp_path, 300_000)
    line, sink = Line(tmp_path, bad(0.0), 5), Bin()
    job = line.read(sink, grows=grows)
    while job._blocks.done < 130_000:
        line.step()
    content = put_log(tmp_path, 300_000, seed=seed)
    line.reboot()
    line.until_ended()
    assert (line.ended, sink.sizes) == ([end], sizes)
    assert end or sink.content == content


def test_a_sink_without_room_gets_no_more_and_the_boat_keeps_the_session(tmp_path: Path) -> None:
    content = put_log(tmp_path, 400_000)
    line, sink = Line(tmp_path, bad(0.0), 5), Bin(200_000)
    line.read(sink)
    for _ in range(round(100.0 / TICK_S)):  # the boat closes what is not used for 30 s
        line.step()
    held = len(sink.content)
    assert held <= 200_000
    assert line.ended == []
    sink.rooms = len(content)
    line.until_ended(limit_s=2.0)
    assert (line.ended, sink.content, sink.sizes) == ([None], content, [len(content)])


def test_a_missing_file_and_a_silent_boat_are_told(tmp_path: Path) -> None:
    line = Line(tmp_path, bad(0.0), 5)
    line.read(Bin(), "logs/99999.bin")
    line.until_ended()
    assert line.ended == [FtpFailure(say("file.not_found"), Code.FILE_NOT_FOUND)]
    line.down.quality = Quality(loss=1.0)
    line.client.list_folder("logs", line.ended.append)
    line.until_ended(2, limit_s=30.0)
    assert line.ended[1] == FtpFailure(say("file.no_answer"))


class Liar:
    """A boat that answers by a script: it holds a file, and lies about it in ways that hypothesis chooses."""

    def __init__(self, content: bytes, size: int, lies: list[tuple[str, int]]) -> None:
        self.content = content
        self.size = size
        self.lies = lies
        self.count = 0

    def answers(self, payload: bytes) -> list[bytes]:
        sequence, session, opcode, size, _, _, _, offset = struct.unpack_from("<HBBBBBBI", payload)
        lie, value = self.lies[self.count % len(self.lies)] if self.lies else ("", 0)
        self.count += 1

        def reply(kind: int, data: bytes, at: int = offset, later: int = 1, is_over: int = 0) -> bytes:
            number = (sequence + later) & 0xFFFF
            header = struct.pack("<HBBBBBBI", number, session, kind, len(data), opcode, is_over, 0, at)
            return header + data.ljust(239, b"\0")

        def end(later: int = 1) -> bytes:
            return reply(129, bytes([Code.END_OF_FILE]), later=later)

        if lie == "silent":
            return []
        if lie == "nak":
            return [reply(129, bytes([value % 12]))]
        if lie == "junk":
            return [random.Random(value).randbytes(value % 252)]
        if opcode == Opcode.OPEN_FILE_RO:
            return [reply(128, self.size.to_bytes(4, "little"))]
        if opcode == Opcode.READ_FILE:
            data = self.content[offset : offset + (1 + value % 239 if lie == "short" else size)]
            return [reply(128, data) if data else end()]
        if opcode == Opcode.BURST_READ_FILE:
            if lie == "barren":
                return [reply(128, b"", is_over=1)]
            out: list[bytes] = []
            step = 1 + value % 239 if lie == "short" else 239
            for later in range(1, 900):
                at = offset + (later - 1) * step
                data = self.content[at : at + step]
                if lie == "endless":  # goes on beyond the end with what is not there
                    data = data or b"x" * step
                elif lie == "far":
                    at += value
                    data = self.content[at : at + step]
                elif not data:
                    return [*out, end(later)]
                out.append(reply(128, data, at, later))
            return out
        return [reply(128, b"")]


LIES = st.tuples(
    st.sampled_from(["", "", "silent", "nak", "junk", "short", "barren", "endless", "far"]),
    st.integers(0, 2**20),
)


@settings(max_examples=60, deadline=None)
@given(
    length=st.integers(0, 60_000),
    announced=st.none() | st.integers(0, 100_000) | st.just(2**32 - 1),
    lies=st.lists(LIES, max_size=12),
    grows=st.booleans(),
    loss=st.sampled_from([0.0, 0.2]),
    seed=st.integers(0, 1000),
)
def test_whatever_a_boat_answers_the_transfer_ends_and_a_success_has_its_bytes(
    length: int,
    announced: int | None,
    lies: list[tuple[str, int]],
    grows: bool,
    loss: float,
    seed: int,
) -> None:
    content = random.Random(7).randbytes(length)
    boat = Liar(content, length if announced is None else announced, lies)
    chance = random.Random(seed)
    inbox: list[bytes] = []
    client = FtpClient(BOAT, STATION.address, lambda message: inbox.append(bytes(message.payload)))
    sink, ended = Bin(), []  # type: ignore[var-annotated]
    client.read(PATH, sink, ended.append, most_bytes=100_000, grows=grows)
    now_s = 0.0
    while not ended or client.is_busy:
        assert now_s < 60.0 + 1000.0 + 60.0, "the transfer does not end"
        now_s += 0.05
        asked, inbox[:] = inbox[:], []
        for payload in asked:
            if chance.random() >= loss:
                answers = boat.answers(payload)
                chance.shuffle(answers) if loss else None
                for answer in answers:
                    if chance.random() >= loss:
                        client.handle(message_of(answer.ljust(251, b"\0")), now_s)
        client.poll(now_s)
    assert len(ended) == 1
    is_honest = not any(lie in ("endless", "nak", "junk", "far") for lie, _ in lies)
    if ended == [None] and is_honest:
        whole = content[: boat.size]
        assert sink.content == whole
        assert not grows or len(whole) == boat.size
    if not lies and announced is None:
        assert ended == [None]
    assert len(sink.content) <= 100_000


def test_long_logs_take_turns_and_a_slow_reader_holds_up_nobody(tmp_path: Path) -> None:
    content = put_log(tmp_path, 300_000)
    other = put_log(tmp_path, 3_000_000, seed=8, name="00002.bin")
    line = Line(tmp_path, bad(0.0), 5)
    slow, quick = Bin(0), Bin()
    line.read(slow)
    line.read(quick, "logs/00002.bin")
    small: list[float] = []
    line.client.read_whole("@PARAM/param.pck", lambda _: small.append(line.now_s))
    line.until_ended(limit_s=60.0)
    assert quick.content == other
    assert small[0] < 6.0, "a small file waited for a large one"
    assert slow.content == b""
    slow.rooms = len(content)
    line.until_ended(2, limit_s=60.0)
    assert (line.ended, slow.content) == ([None, None], content)
    assert (slow.sizes, quick.sizes) == ([len(content)], [len(other)])


@pytest.mark.parametrize("loss", [0.05, 0.4])
def test_an_upload_over_a_bad_link_ends_whole_and_late_copies_change_nothing(
    tmp_path: Path, loss: float
) -> None:
    content = random.Random(1).randbytes(5000)
    line = Line(tmp_path, bad(loss), 100)
    session = line.ask(Opcode.CREATE_FILE, b"/files/a.bin").session
    for offset in range(0, len(content), 239):
        assert line.ask(Opcode.WRITE_FILE, content[offset : offset + 239], session, offset).opcode == ACK
    assert line.ask(Opcode.TERMINATE_SESSION, session=session).opcode == ACK
    for _ in range(500):
        line.step()
    assert (tmp_path / "files" / "a.bin").read_bytes() == content


@pytest.mark.parametrize("loss", [0.05, 0.4])
def test_what_may_happen_only_once_happens_once(tmp_path: Path, loss: float) -> None:
    line = Line(tmp_path, bad(loss), 5)
    for number in range(8):
        name = b"/files/%d" % number
        assert line.ask(Opcode.CREATE_DIRECTORY, name).opcode == ACK
        assert line.ask(Opcode.RENAME, name + b"\0" + name + b"x").opcode == ACK
        assert line.ask(Opcode.REMOVE_DIRECTORY, name + b"x").opcode == ACK
    assert not list((tmp_path / "files").iterdir())
