"""LOG_*: lists and downloads, as stations ask for them through real frames."""

import random
from itertools import pairwise
from pathlib import Path

import pytest
from boat_rig import BOAT, OK, PLANNER, Peer, Rig
from hypothesis import given
from hypothesis import strategies as st
from late_worker import LateWorker
from log_rig import LogRig, OpenRig

from companion.core.storage import InlineExecutor
from companion.log.sink import Worker
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.services.logs import CHUNK_BYTES, LogService
from companion.services.outbox import Origin, Outbox
from companion.services.statustext import StatusTextService

pytest_plugins = ("log_fixtures",)

ALL = 0xFFFFFFFF


def content_of(size_bytes: int, seed: int = 1) -> bytes:
    """Bytes that nothing else would be."""
    return random.Random(seed).randbytes(size_bytes)


def fill(folder: Path, *sizes: int) -> list[bytes]:
    """Logs of earlier voyages, the oldest first."""
    folder.mkdir(parents=True, exist_ok=True)
    contents = [content_of(size, seed) for seed, size in enumerate(sizes, 1)]
    for number, content in enumerate(contents, 1):
        (folder / f"{number:05d}.bin").write_bytes(content)
    return contents


def request_list(peer: Peer, start: int = 0, end: int = 0xFFFF) -> None:
    peer.send(dialect.MAVLink_log_request_list_message(*BOAT, start, end))


def request(peer: Peer, number: int, offset: int = 0, count: int = ALL) -> None:
    peer.send(dialect.MAVLink_log_request_data_message(*BOAT, number, offset, count))


def entries(rig: Rig, start: int = 0, end: int = 0xFFFF) -> list[tuple[int, int, int, int]]:
    """Number, number of logs, last number, size."""
    rig.peer.forget()
    request_list(rig.peer, start, end)
    rig.run(0.2)
    return [(e.id, e.num_logs, e.last_log_num, e.size) for e in rig.peer.said("LOG_ENTRY")]


def put_together(chunks: list[Message], size: int) -> bytes:
    """What the chunks are parts of; a byte that none has is a failure."""
    content: list[int | None] = [None] * size
    for chunk in chunks:
        content[chunk.ofs : chunk.ofs + chunk.count] = chunk.data[: chunk.count]
    assert None not in content
    return bytes(byte for byte in content if byte is not None)


def test_the_whole_list_counts_from_zero_as_mavsdk_expects(open_rig: OpenRig, tmp_path: Path) -> None:
    fill(tmp_path, 100, 200, 300)
    rig = open_rig(tmp_path)
    assert entries(rig) == [(0, 3, 2, 300), (1, 3, 2, 100), (2, 3, 2, 200)]
    assert entries(rig, 1, 2) == [(1, 3, 2, 100), (2, 3, 2, 200)]
    assert entries(rig, 3, 9) == [(3, 3, 2, 300)], "which QGroundControl misses in the list"


@pytest.mark.parametrize(("size", "number"), [(1, 0), (89, 1), (90, 0), (180, 1), (200_000, 1)])
def test_a_download_is_the_file_to_the_byte(
    open_rig: OpenRig, tmp_path: Path, size: int, number: int
) -> None:
    (content,) = fill(tmp_path, size)
    rig = open_rig(tmp_path)
    rig.run(0.1)
    request(rig.peer, number)
    rig.run(0.1 + size / 1e5)
    chunks = rig.peer.said("LOG_DATA")
    assert put_together(chunks, size) == content
    assert {chunk.id for chunk in chunks} == {number}
    assert chunks[-1].count < CHUNK_BYTES  # which is how MAVProxy knows that it has all
    assert len(chunks) == size // CHUNK_BYTES + 1


def test_a_station_that_asks_at_every_chunk_for_the_rest_is_not_sent_it_every_time(
    open_rig: OpenRig, tmp_path: Path
) -> None:
    """MAVSDK asks for what it still misses of a part as soon as each chunk comes."""
    fill(tmp_path, 46_080)
    rig = open_rig(tmp_path)
    rig.run(0.1)
    end = 100 * CHUNK_BYTES
    request(rig.peer, 1, 0, end)
    for chunk in range(1, 100):
        request(rig.peer, 1, chunk * CHUNK_BYTES, end - chunk * CHUNK_BYTES)
    rig.run(0.08)
    assert len(rig.peer.said("LOG_DATA")) == 100
    rig.run(0.5)  # what has not come by now is lost
    rig.peer.forget()
    request(rig.peer, 1, 99 * CHUNK_BYTES, CHUNK_BYTES)
    rig.run(0.1)
    assert [chunk.ofs for chunk in rig.peer.said("LOG_DATA")] == [99 * CHUNK_BYTES]


def test_a_tick_sends_no_more_than_its_share_and_less_while_the_boat_is_busy(
    open_rig: OpenRig, tmp_path: Path
) -> None:
    fill(tmp_path, 3_000_000)
    rig = open_rig(tmp_path)
    rig.run(0.1)
    request(rig.peer, 1)
    sent = []
    for load in (0.1,) * 80 + (0.9,) * 80:
        rig.boat.load = load
        rig.step()
        sent.append(sum(m.get_type() == "LOG_DATA" for m in rig.peer.listen()))
    assert sent[:2] == [8 + 36, 40]  # the first tick hears the request, too
    assert max(sent) == sent[79] == 256
    assert sent[80:] == sorted(sent[80:], reverse=True)
    assert sent[-1] == 8
    rig.boat.load = 0.1
    rig.peer.send(dialect.MAVLink_log_request_end_message(*BOAT))
    rig.run(0.2)
    rig.peer.forget()
    request(rig.peer, 1)
    rig.step()
    assert len(rig.peer.said("LOG_DATA")) == 8 + 36, "the next one begins anew"


def test_logs_are_erased_unless_the_boat_is_armed(open_rig: OpenRig, tmp_path: Path) -> None:
    fill(tmp_path, 100, 200)
    rig = open_rig(tmp_path, config={"log.after_disarm_s": 0.1}).ready()
    assert rig.arm() == OK
    rig.run(0.1)
    rig.peer.send(dialect.MAVLink_log_erase_message(*BOAT))
    rig.run(0.1)
    assert [file.number for file in rig.store.files] == [1, 2, 3]
    assert "Logs are not erased while the boat is armed" in rig.peer.texts
    rig.disarm()
    rig.peer.send(dialect.MAVLink_log_erase_message(*BOAT))
    rig.run(0.1)
    assert not rig.store.files
    assert entries(rig) == [(0, 0, 0, 0)]


class Desk:
    """The service alone, with a worker that may be late and a link that may be full."""

    def __init__(self, folder: Path, worker: Worker) -> None:
        rig = LogRig(folder, worker=worker)
        self.worker = worker
        self.outbox = Outbox()
        self.service = LogService(
            Address(*BOAT), rig.boat.vehicle, self.outbox, StatusTextService(self.outbox), rig.logbook
        )

    def ask(self, number: int, offset: int, count: int, now_s: float) -> None:
        message = dialect.MAVLink_log_request_data_message(*BOAT, number, offset, count)
        self.service.handle(message, Origin(1, PLANNER), now_s)

    def sent(self) -> list[Message]:
        return [out.message for out in self.outbox.drain()]


def test_a_medium_that_is_slow_to_read_delays_the_download_not_the_tick(tmp_path: Path) -> None:
    (content,) = fill(tmp_path, 300_000)
    worker = LateWorker()
    desk = Desk(tmp_path, worker)
    desk.ask(1, 0, ALL, 0.0)
    chunks = []
    for tick in range(400):
        desk.service.tick(0.02 * tick, 0.0)
        chunks += desk.sent()
        if tick % 10 == 0:
            assert len(worker.jobs) <= 3
            worker.work()
    assert put_together(chunks, 300_000) == content


asks = st.tuples(
    st.integers(0, 4),
    st.integers(0, 12_000),
    st.one_of(st.integers(0, 12_000), st.just(ALL)),
    st.integers(0, 30),
)


@given(asks=st.lists(asks, max_size=40), seed=st.integers(0, 99))
def test_any_requests_give_correct_chunks_and_end(
    tmp_path_factory: pytest.TempPathFactory, asks: list[tuple[int, int, int, int]], seed: int
) -> None:
    folder = tmp_path_factory.mktemp("logs")
    contents = fill(folder, 0, 900, 10_000)
    contents.append(contents[-1])  # number 0 is the newest
    desk = Desk(folder, Worker(InlineExecutor()))
    now_s, most = 0.0, 0
    chunks: list[Message] = []
    for number, offset, count, ticks in asks:
        desk.ask(number, offset, count, now_s)
        chunks += desk.sent()
        most += min(max(10_000 - offset, 0), count) // CHUNK_BYTES + 3
        for _ in range(ticks):
            desk.service.tick(now_s, 0.0)
            now_s += 0.02
            new = desk.sent()
            assert len(new) <= 256
            chunks += new
    for _ in range(200):
        desk.service.tick(now_s, 0.0)
        now_s += 0.02
        chunks += desk.sent()
    desk.service.tick(now_s, 0.0)
    assert desk.sent() == []
    assert len(chunks) <= most
    for chunk in chunks:
        if chunk.id <= 3:
            whole = contents[chunk.id - 1]
            assert bytes(chunk.data[: chunk.count]) == whole[chunk.ofs : chunk.ofs + chunk.count]


@pytest.mark.parametrize("loss", [0.05, 0.4])
def test_a_patient_station_gets_the_whole_log_over_a_link_that_loses(tmp_path: Path, loss: float) -> None:
    """As QGroundControl does it: part by part, missing chunks asked for after a silence."""
    (content,) = fill(tmp_path, 200 * CHUNK_BYTES + 17)
    desk, dice = Desk(tmp_path, Worker(InlineExecutor())), random.Random(7)
    held: dict[int, bytes] = {}
    now_s, silent_since_s = 0.0, -1.0
    wanted = set(range(0, len(content), CHUNK_BYTES))
    for _ in range(30_000):
        missing = sorted(wanted - held.keys())
        if not missing:
            break
        if now_s - silent_since_s > 0.5:
            silent_since_s = now_s
            last = next((a for a, b in pairwise([*missing, ALL]) if b != a + CHUNK_BYTES), missing[-1])
            if dice.random() >= loss:
                desk.ask(1, missing[0], last + CHUNK_BYTES - missing[0], now_s)
        desk.service.tick(now_s, 0.0)
        for chunk in desk.sent():
            if dice.random() >= loss:
                held[chunk.ofs] = bytes(chunk.data[: chunk.count])
                silent_since_s = now_s
        now_s += 0.02
    assert b"".join(held[offset] for offset in sorted(held)) == content
