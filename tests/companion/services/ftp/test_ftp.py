"""The file server, request by request."""

import errno
import os
import struct
import zlib
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import pytest
from ftp_client import ACK, BOAT, STATION, Reply, Served, reply_of, request_of
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.mavftp import MAVFTP

from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.mavlink.address import Address
from companion.mavlink.dialect import dialect
from companion.mavlink.ftp_frames import Code, Opcode
from companion.services.ftp.bursts import BLOCKS_PER_TICK
from companion.services.ftp.folder import DiskReading
from companion.services.ftp.service import REQUESTS_PER_TICK
from companion.services.ftp.sessions import IDLE_S, MAX_SESSIONS, MAX_STATIONS, MAX_UPLOAD_BYTES, Session
from companion.services.outbox import Origin

TEXT = bytes(range(256)) * 5  # five blocks and a bit, zeros among them


PATHS = [b"/files/a", b"/files", b"@PARAM/param.pck", b"", b"/files/a\0/files/b", b"\xff/.."]


class Slow(Executor):
    """A worker that does nothing until it is told to."""

    def __init__(self) -> None:
        self.waiting: list[tuple[Future[Any], Any]] = []
        self.is_shut = False

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":  # noqa: ANN401
        future: Future[Any] = Future()
        self.waiting.append((future, lambda: fn(*args, **kwargs)))
        return future

    def work(self) -> None:
        waiting, self.waiting = self.waiting, []
        for future, job in waiting:
            try:
                future.set_result(job())
            except Exception as error:
                future.set_exception(error)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        self.work()
        self.is_shut = wait


@pytest.fixture
def served(tmp_path: Path) -> Served:
    return Served(tmp_path)


def test_a_file_that_is_put_comes_back_and_lies_in_the_folder(served: Served, tmp_path: Path) -> None:
    assert served.put(b"/files/a.bin", TEXT).opcode == ACK
    assert (tmp_path / "files" / "a.bin").read_bytes() == TEXT
    assert served.get(b"/files/a.bin") == TEXT
    assert served.get(b"files//./a.bin\0") == TEXT
    served.put(b"/files/a.bin", b"short")
    assert served.get(b"/files/a.bin") == b"short", "nothing of the old file is left"


@pytest.mark.parametrize("how", ["link gone", "idle"])
def test_an_upload_that_breaks_off_leaves_the_old_file(served: Served, tmp_path: Path, how: str) -> None:
    served.put(b"/files/a.bin", b"old")
    session = served.ask(Opcode.CREATE_FILE, b"/files/a.bin").session
    served.ask(Opcode.WRITE_FILE, b"new", session)
    if how == "idle":
        served.tick(IDLE_S + 1.0)
    else:
        served.service.forget(STATION.channel)
    assert served.ask(Opcode.WRITE_FILE, b"more", session).code is Code.INVALID_SESSION
    assert (tmp_path / "files" / "a.bin").read_bytes() == b"old"


def test_reset_keeps_what_was_written_and_not_what_was_only_begun(served: Served, tmp_path: Path) -> None:
    served.put(b"/files/begun", b"old")
    written = served.ask(Opcode.CREATE_FILE, b"/files/written", session=1).session
    served.ask(Opcode.WRITE_FILE, b"new", written)
    served.ask(Opcode.CREATE_FILE, b"/files/begun", session=2)
    assert served.ask(Opcode.RESET_SESSIONS).opcode == ACK
    assert (tmp_path / "files" / "written").read_bytes() == b"new"
    assert (tmp_path / "files" / "begun").read_bytes() == b"old"
    assert served.ask(Opcode.WRITE_FILE, b"x", written).code is Code.INVALID_SESSION


def test_write_only_keeps_what_is_there(served: Served, tmp_path: Path) -> None:
    served.put(b"/files/a", b"abcdef")
    session = served.ask(Opcode.OPEN_FILE_WO, b"/files/a").session
    served.ask(Opcode.WRITE_FILE, b"XY", session, offset=2)
    served.ask(Opcode.WRITE_FILE, b"!", session, offset=8)
    served.ask(Opcode.TERMINATE_SESSION, session=session)
    assert (tmp_path / "files" / "a").read_bytes() == b"abXYef\0\0!"


def test_the_root_lists_its_folders_and_these_their_files(served: Served) -> None:
    assert served.list(b"/") == served.list(b"") == ["D@PARAM", "D@SYS", "Dfiles", "Dlogs", "Dmetadata"]
    assert served.list(b"/files") == []
    served.put(b"/files/a.txt", b"12345")
    served.ask(Opcode.CREATE_DIRECTORY, b"/files/sub")
    assert served.list(b"/files") == ["Fa.txt\t5", "Dsub"]
    assert served.list(b"/@PARAM")[0].startswith("Fparam.pck\t")


def test_logs_are_read_only_and_have_an_alias(served: Served, tmp_path: Path) -> None:
    assert served.list(b"/logs") == []
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs" / "00001.bin").write_bytes(TEXT)
    assert served.list(b"@LOGS") == served.list(b"/logs") == [f"F00001.bin\t{len(TEXT)}"]
    assert served.get(b"@LOGS/00001.bin") == TEXT
    for opcode in (Opcode.CREATE_FILE, Opcode.OPEN_FILE_WO, Opcode.REMOVE_FILE, Opcode.TRUNCATE_FILE):
        assert served.ask(opcode, b"/logs/00001.bin").code is Code.FILE_PROTECTED
    assert served.ask(Opcode.RENAME, b"/logs/00001.bin\0/files/x").code is Code.FILE_PROTECTED
    assert (tmp_path / "logs" / "00001.bin").read_bytes() == TEXT


@pytest.mark.parametrize(
    ("opcode", "data", "code"),
    [
        (Opcode.OPEN_FILE_RO, b"/files/none", Code.FILE_NOT_FOUND),
        (Opcode.OPEN_FILE_RO, b"/files", Code.FILE_NOT_FOUND),
        (Opcode.OPEN_FILE_RO, b"/none", Code.FILE_NOT_FOUND),
        (Opcode.OPEN_FILE_RO, b"/", Code.FILE_PROTECTED),
        (Opcode.OPEN_FILE_RO, b"@PARAM/other", Code.FILE_NOT_FOUND),
        (Opcode.OPEN_FILE_RO, b"@PARAM/param.pck?start=9999", Code.FAIL_ERRNO),
        (Opcode.LIST_DIRECTORY, b"/files/none", Code.FILE_NOT_FOUND),
        (Opcode.CREATE_FILE, b"/files/none/a", Code.FILE_NOT_FOUND),
        (Opcode.CREATE_FILE, b"/a", Code.FILE_NOT_FOUND),
        (Opcode.CREATE_FILE, b"/files", Code.FILE_PROTECTED),
        (Opcode.CREATE_FILE, b"/metadata/general.json", Code.FILE_PROTECTED),
        (Opcode.REMOVE_FILE, b"/files/none", Code.FILE_NOT_FOUND),
        (Opcode.CREATE_DIRECTORY, b"/files/full", Code.FILE_EXISTS),
        (Opcode.REMOVE_DIRECTORY, b"/files/full", Code.FAIL_ERRNO),
        (Opcode.REMOVE_DIRECTORY, b"/files", Code.FILE_PROTECTED),
        (Opcode.RENAME, b"/files/full\0/files/there", Code.FILE_EXISTS),
        (Opcode.RENAME, b"/files/none\0/files/x", Code.FILE_NOT_FOUND),
        (Opcode.RENAME, b"/files/there", Code.FILE_PROTECTED),
        (Opcode.TRUNCATE_FILE, b"/files/none", Code.FILE_NOT_FOUND),
        (Opcode.CALC_FILE_CRC32, b"/files/none", Code.FILE_NOT_FOUND),
        (Opcode.READ_FILE, b"", Code.INVALID_SESSION),
        (Opcode.BURST_READ_FILE, b"", Code.INVALID_SESSION),
        (Opcode.WRITE_FILE, b"x", Code.INVALID_SESSION),
        (Opcode.TERMINATE_SESSION, b"", Code.INVALID_SESSION),
        (16, b"/files", Code.UNKNOWN_COMMAND),
        (127, b"", Code.UNKNOWN_COMMAND),
    ],
)
def test_a_refusal_says_why(tmp_path: Path, opcode: int, data: bytes, code: Code) -> None:
    served = Served(tmp_path)
    (tmp_path / "files" / "full").mkdir()
    (tmp_path / "files" / "full" / "x").touch()
    (tmp_path / "files" / "there").touch()
    reply = served.ask(opcode, data, session=9)
    assert reply.code is code
    assert len(reply.data) == (2 if code is Code.FAIL_ERRNO else 1)


def test_what_is_being_written_cannot_be_read_nor_the_other_way_round(served: Served) -> None:
    writing = served.ask(Opcode.CREATE_FILE, b"/files/a", session=1).session
    reading = served.ask(Opcode.OPEN_FILE_RO, b"/metadata/general.json", session=2).session
    assert served.ask(Opcode.READ_FILE, session=writing).code is Code.FILE_PROTECTED
    assert served.ask(Opcode.BURST_READ_FILE, session=writing).code is Code.FILE_PROTECTED
    assert served.ask(Opcode.WRITE_FILE, b"x", reading).code is Code.FILE_PROTECTED
    assert served.tick() == []


def is_open(path: Path) -> bool:
    return any(os.path.realpath(fd) == str(path) for fd in Path("/proc/self/fd").iterdir())


def test_the_checksum_is_mavlinks_and_leaves_no_file_open(served: Served, tmp_path: Path) -> None:
    served.put(b"/files/a.bin", TEXT)
    crc = struct.unpack("<I", served.ask(Opcode.CALC_FILE_CRC32, b"/files/a.bin").data)[0]
    assert crc == zlib.crc32(TEXT, 0xFFFFFFFF) ^ 0xFFFFFFFF
    assert not is_open(tmp_path / "files" / "a.bin")


def test_all_uploads_together_are_bounded(served: Served) -> None:
    codes = []
    for number in range(6):
        session = served.ask(Opcode.CREATE_FILE, b"/files/%d" % number, session=number).session
        codes.append(served.ask(Opcode.WRITE_FILE, b"x", session, MAX_UPLOAD_BYTES - 1).code)
    assert codes == [None] * 4 + [Code.FAIL] * 2
    assert served.ask(Opcode.WRITE_FILE, b"y", 0).code is None, "it grows no more"


def test_a_session_has_the_number_that_was_asked_for_or_the_lowest_free_one(served: Served) -> None:
    path = b"/metadata/general.json"
    assert served.ask(Opcode.OPEN_FILE_RO, path, session=7).session == 7
    assert served.ask(Opcode.OPEN_FILE_RO, path, session=7).session == 0
    assert served.ask(Opcode.OPEN_FILE_RO, path, session=0).session == 1
    other = Origin(4, STATION.address)
    assert served.ask(Opcode.OPEN_FILE_RO, path, session=7, origin=other).session == 7


def test_sessions_are_bounded_and_free_again_when_closed_or_idle(served: Served, tmp_path: Path) -> None:
    path = b"/metadata/general.json"
    for number in range(MAX_SESSIONS):
        assert served.ask(Opcode.OPEN_FILE_RO, path, session=number).opcode == ACK
    (tmp_path / "files" / "a").write_bytes(TEXT)
    assert served.ask(Opcode.OPEN_FILE_RO, b"/files/a", session=99).code is Code.NO_SESSIONS_AVAILABLE
    assert not is_open(tmp_path / "files" / "a")
    served.ask(Opcode.TERMINATE_SESSION, session=0)
    assert served.ask(Opcode.OPEN_FILE_RO, path, session=99).opcode == ACK
    for _ in range(2):
        served.tick(IDLE_S - 1.0)
        assert served.ask(Opcode.READ_FILE, session=99, size=9).opcode == ACK, "it is in use"
    served.tick(IDLE_S + 1.0)
    assert not served.service._stations
    assert served.ask(Opcode.OPEN_FILE_RO, path, session=98).opcode == ACK


def test_one_station_cannot_use_or_close_what_another_has_open(served: Served) -> None:
    session = served.ask(Opcode.OPEN_FILE_RO, b"/metadata/general.json").session
    for other in (Origin(4, STATION.address), Origin(3, Address(254, 190))):
        assert served.ask(Opcode.READ_FILE, session=session, origin=other).code is Code.INVALID_SESSION
        assert served.ask(Opcode.RESET_SESSIONS, origin=other).opcode == ACK
    assert served.ask(Opcode.READ_FILE, session=session, size=9).opcode == ACK


def opened(served: Served, origin: Origin) -> Reply:
    served.now_s += 0.02
    served.service.tick(served.now_s)
    return served.ask(Opcode.OPEN_FILE_RO, b"@PARAM/param.pck", origin=origin)


def invented(channel: int, count: int = 250) -> list[Origin]:
    return [Origin(channel, Address(number + 1, 190)) for number in range(count)]


def test_invented_addresses_with_open_files_are_refused_in_words_and_lock_out_nobody_on_another_link(
    served: Served,
) -> None:
    replies = [opened(served, origin) for origin in invented(7)]
    assert [reply.opcode for reply in replies[:MAX_STATIONS]] == [ACK] * MAX_STATIONS
    assert {reply.code for reply in replies[MAX_STATIONS:]} == {Code.NO_SESSIONS_AVAILABLE}
    others = [Origin(channel, Address(255, 190)) for channel in range(20, 35)]
    assert {opened(served, origin).opcode for origin in others} == {ACK}
    assert len(list(served.service._stations)) == MAX_STATIONS
    assert served.service.dropped == 0


def test_whoever_makes_way_is_the_longest_silent_of_the_fullest_link_and_its_file_is_closed(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    for origin in invented(7, MAX_STATIONS):
        opened(served, origin)
    first = invented(7, 1)[0]
    opened(served, first)  # which is now the latest to be heard
    closed: list[Session] = []
    monkeypatch.setattr(served.service, "_release", closed.extend)
    opened(served, STATION)
    assert len(closed) == 1
    kept = {station.origin for station in served.service._stations}
    assert first in kept
    assert invented(7, 2)[1] not in kept


@pytest.mark.parametrize(
    "counts", [(16, 16, 0), (16, 15, 1)], ids=["as many", "one more, which would come back"]
)
def test_links_with_as_many_stations_as_others_displace_none(served: Served, counts: tuple[int, ...]) -> None:
    assert sum(counts) == MAX_STATIONS
    for channel, count in zip((7, 8, 9), counts, strict=True):
        for origin in invented(channel, count):
            opened(served, origin)
    late = Origin(8, Address(200, 190))
    assert opened(served, late).code is Code.NO_SESSIONS_AVAILABLE


def test_a_repeated_request_gets_the_same_answer_and_is_not_carried_out_twice(
    served: Served, tmp_path: Path
) -> None:
    served.put(b"/files/a", b"x")
    message = request_of(500, Opcode.REMOVE_FILE, b"/files/a")
    first = served.send(message)
    (tmp_path / "files" / "a").write_bytes(b"made since")
    assert served.send(message) == first
    assert first[0].opcode == ACK
    assert (tmp_path / "files" / "a").read_bytes() == b"made since"
    served.tick(60.0)
    assert served.send(message)[0].opcode == ACK  # so much later, it is meant
    assert not (tmp_path / "files" / "a").exists()


def burst(served: Served, path: bytes, size: int = 239, offset: int = 0) -> list[Any]:
    session = served.ask(Opcode.OPEN_FILE_RO, path).session
    replies = served.send(request_of(10, Opcode.BURST_READ_FILE, session=session, size=size, offset=offset))
    while not (replies and (replies[-1].is_burst_over or replies[-1].code)):
        replies += served.tick()
    return replies


@pytest.mark.parametrize("size", [239, 80, 0])
def test_a_burst_sends_every_block_in_order_and_then_the_end(served: Served, size: int) -> None:
    content = os.urandom(70_000)
    served.put(b"/files/a", content)
    *blocks, end = burst(served, b"/files/a", size)
    assert [block.sequence for block in (*blocks, end)] == [11 + n for n in range(len(blocks) + 1)]
    sent = b"".join(block.data for block in blocks)
    assert sent == content[: len(sent)]
    step = size or 239
    assert [block.offset for block in blocks] == [step * n for n in range(len(blocks))]
    if size == 80:
        assert end.is_burst_over
        assert end.opcode == ACK
    else:
        assert (end.code, end.offset) == (Code.END_OF_FILE, len(content))


def test_a_burst_goes_on_where_what_is_in_memory_ends(served: Served) -> None:
    content = os.urandom(263_000)
    served.put(b"/files/a", content)
    *blocks, end = burst(served, b"/files/a", offset=261_000)
    assert b"".join(block.data for block in blocks) == content[261_000:]
    assert end.code is Code.END_OF_FILE


def test_bursts_of_two_stations_share_the_tick(served: Served) -> None:
    served.put(b"/files/a", bytes(100_000))
    other = Origin(4, STATION.address)
    for origin in (STATION, other):
        session = served.ask(Opcode.OPEN_FILE_RO, b"/files/a", origin=origin).session
        served.send(request_of(10, Opcode.BURST_READ_FILE, session=session, size=239), origin)
    for _ in range(2):
        served.service.tick(served.now_s)
        out = [outgoing.channel for outgoing in served.outbox.drain()]
        assert (out.count(3), out.count(4)) == (BLOCKS_PER_TICK // 2, BLOCKS_PER_TICK // 2)


def test_a_burst_waits_for_room_on_its_channel(served: Served) -> None:
    served.put(b"/files/a", bytes(10_000))
    session = served.ask(Opcode.OPEN_FILE_RO, b"/files/a").session
    served.outbox.room = lambda _: 1
    request = request_of(10, Opcode.BURST_READ_FILE, session=session, size=239)
    assert [block.offset for block in served.send(request)] == [0]
    assert [block.offset for block in served.send(request)] == [239], "a repeated request does not begin anew"
    for number in range(2, 5):  # nor does the session end for want of requests
        assert [block.offset for block in served.tick(0.6 * IDLE_S)] == [239 * number]
    served.outbox.room = lambda _: 0
    assert served.tick() == []
    served.outbox.room = lambda _: 10**6
    assert len(served.tick()) > 30


@pytest.mark.parametrize("is_broken", [False, True])
def test_a_burst_waits_for_the_disk_and_ends_when_it_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_broken: bool
) -> None:
    worker, content = Slow(), os.urandom(263_000)
    served = Served(tmp_path, worker)
    (tmp_path / "files" / "a").write_bytes(content)
    served.send(request_of(1, Opcode.OPEN_FILE_RO, b"/files/a"))
    worker.work()
    (opened,) = served.tick()
    request = request_of(10, Opcode.BURST_READ_FILE, session=opened.session, size=239, offset=262_000)
    assert served.send(request) == served.tick() == []
    assert len(worker.waiting) == 1

    def fail(*_: object) -> None:
        raise OSError(errno.EIO, "the card is gone")

    if is_broken:
        monkeypatch.setattr(DiskReading, "load", fail)
        worker.waiting = [(future, fail) for future, _ in worker.waiting]
    worker.work()
    *blocks, end = served.tick()
    assert b"".join(block.data for block in blocks) == (b"" if is_broken else content[262_000:])
    assert end.code is (Code.FAIL_ERRNO if is_broken else Code.END_OF_FILE)
    assert end.sequence == 11 + len(blocks)
    assert served.tick() == []
    assert worker.waiting == []


def test_the_loop_never_waits_for_the_disk(tmp_path: Path) -> None:
    worker = Slow()
    served = Served(tmp_path, worker)
    (tmp_path / "files" / "a").write_bytes(TEXT)
    opening = request_of(1, Opcode.OPEN_FILE_RO, b"/files/a")
    assert served.send(opening) == served.send(opening) == served.tick() == []
    assert len(worker.waiting) == 1
    assert served.send(request_of(2, Opcode.OPEN_FILE_RO, b"/metadata/general.json", session=5))
    worker.work()
    (opened,) = served.tick()
    assert (opened.sequence, struct.unpack("<I", opened.data)) == (2, (len(TEXT),))
    assert served.send(opening) == [opened]
    served.service.close()
    assert worker.is_shut


def test_what_is_sent_without_waiting_for_answers_is_carried_out_in_order(tmp_path: Path) -> None:
    worker = Slow()
    served = Served(tmp_path, worker)
    served.send(request_of(1, Opcode.CREATE_FILE, b"/files/a", session=3))
    served.send(request_of(2, Opcode.WRITE_FILE, b"ab", session=3))
    served.send(request_of(2, Opcode.WRITE_FILE, b"ab", session=3))
    served.send(request_of(3, Opcode.WRITE_FILE, b"cd", session=3, offset=2))
    served.send(request_of(4, Opcode.TERMINATE_SESSION, session=3))
    served.send(request_of(5, Opcode.OPEN_FILE_RO, b"/files/a", session=3))
    (other,) = served.send(request_of(6, Opcode.NONE, session=4))
    assert other.sequence == 7
    worker.work()
    assert [(reply.sequence, reply.code) for reply in served.tick()] == [(2, None), (3, None), (4, None)]
    worker.work()
    assert [(reply.sequence, reply.code) for reply in served.tick()] == [(5, None)]
    worker.work()
    assert [(reply.sequence, reply.data) for reply in served.tick()] == [(6, b"\4\0\0\0")]
    assert (tmp_path / "files" / "a").read_bytes() == b"abcd"


def test_what_waits_its_turn_is_bounded(tmp_path: Path) -> None:
    served = Served(tmp_path, Slow())
    for number in range(100):
        served.send(request_of(number, Opcode.LIST_DIRECTORY, b"/files"))
    (station,) = served.service._stations
    assert len(station.queued) == 32
    assert served.service.dropped == 100 - 1 - 32


def test_late_answers_are_dropped_once_the_link_has_closed(tmp_path: Path) -> None:
    worker = Slow()
    served = Served(tmp_path, worker)
    (tmp_path / "files" / "a").write_bytes(TEXT)
    served.send(request_of(1, Opcode.OPEN_FILE_RO, b"/files/a"))
    served.service.forget(STATION.channel)
    worker.work()
    served.tick()
    assert not served.service._stations
    assert not is_open(tmp_path / "files" / "a")


def test_requests_beyond_a_tick_are_dropped_and_the_next_tick_takes_more(served: Served) -> None:
    answered = [served.send(request_of(number, Opcode.NONE)) for number in range(2 * REQUESTS_PER_TICK)]
    assert sum(map(len, answered)) == REQUESTS_PER_TICK
    served.tick()
    assert served.send(request_of(9999, Opcode.NONE))


@given(
    payloads=st.lists(
        st.tuples(
            st.integers(0, 3), st.integers(0, 2), st.integers(0, 20), st.integers(0, 255),
            st.integers(0, 600), st.sampled_from(PATHS),
        ),
        max_size=30,
    ),
    scraps=st.binary(min_size=251, max_size=251),
)  # fmt: skip
def test_any_request_is_answered_at_most_once(
    tmp_path_factory: pytest.TempPathFactory, payloads: list[tuple[int, ...]], scraps: bytes
) -> None:
    served = Served(tmp_path_factory.mktemp("boat"))
    for sequence, session, opcode, size, offset, path in payloads:
        message = request_of(sequence, opcode, path, session, offset, size)  # type: ignore[arg-type]
        replies = served.send(message)
        if opcode != Opcode.BURST_READ_FILE:
            assert len(replies) <= 1
        assert all(reply.request_opcode == opcode for reply in replies)
        served.tick()
    served.send(dialect.MAVLink_file_transfer_protocol_message(0, *BOAT, scraps))


def test_stations_get_the_parameters_as_one_file(served: Served) -> None:
    for path in (b"@PARAM/param.pck", b"/@PARAM/param.pck?withdefaults=1&unknown=x"):
        decoded = MAVFTP.ftp_param_decode(served.get(path))
        assert decoded is not None
        assert [name.decode() for name, _, _ in decoded.params] == [row.name for row in ROWS]
    assert served.get(b"@PARAM/param.pck?withdefaults=1")[:2] == b"\x1c\x67"
    part = served.get(b"@PARAM/param.pck?start=5&count=7")
    assert struct.unpack_from("<HHH", part) == (0x671B, 7, len(ROWS))
    session = served.ask(Opcode.OPEN_FILE_RO, b"@PARAM/param.pck").session
    served.parameters.set("HDG_KP", 4.0)  # the file is as it was when it was opened
    block = served.ask(Opcode.READ_FILE, session=session, size=239)
    assert block.opcode == ACK
    served.ask(Opcode.TERMINATE_SESSION, session=session)
    assert reply_of(bytes(251)).opcode == 0


def parameter_file(*entries: tuple[bytes, float]) -> bytes:
    body = b"".join(
        bytes((4, (len(name) - 1) << 4)) + name + struct.pack("<f", value) for name, value in entries
    )
    return struct.pack("<HHH", 0x671B, len(entries), 6 + len(body)) + body


def value(served: Served, name: str) -> float:
    return served.parameters.value(ROWS[served.parameters.index_of(name) or 0])


def test_a_file_of_parameters_sets_them_and_everyone_hears_of_it(served: Served) -> None:
    file = parameter_file((b"HDG_KP", 3.5), (b"NOT_THERE", 1.0), (b"HDG_KI", 99.0))
    session = served.ask(Opcode.CREATE_FILE, b"@PARAM/param.pck").session
    served.ask(Opcode.WRITE_FILE, file, session)
    assert value(served, "HDG_KP") == BoatConfig().heading.kp
    for channel in (1, 2):
        served.listings.open(channel)
    served.service.handle(request_of(77, Opcode.TERMINATE_SESSION, session=session), STATION, 0.0)
    out = served.outbox.drain()
    said = [(o.channel, o.message.param_value) for o in out if o.message.get_type() == "PARAM_VALUE"]
    texts = [o.message.text for o in out if o.message.get_type() == "STATUSTEXT"]
    assert said == [(1, 3.5), (2, 3.5)]
    assert texts == ["HDG_KI: 99 is outside 0..50"]
    assert value(served, "HDG_KP") == 3.5


def test_a_file_that_is_none_of_parameters_is_refused_at_its_end(served: Served) -> None:
    assert served.put(b"@PARAM/param.pck", parameter_file((b"HDG_KP", 3.5))[:-1]).code is Code.FAIL
    assert value(served, "HDG_KP") == BoatConfig().heading.kp
    assert served.put(b"@PARAM/param.pck", bytes(70_000)).code is Code.FAIL_ERRNO


def test_a_write_far_away_is_refused_and_costs_no_memory(served: Served) -> None:
    session = served.ask(Opcode.CREATE_FILE, b"/files/a").session
    for offset in (MAX_UPLOAD_BYTES, 2**32 - 1):
        assert served.ask(Opcode.WRITE_FILE, b"x", session, offset).code is Code.FAIL_ERRNO
    assert served.service._stations.uploads_bytes() == 0


def test_a_link_is_listed_as_nothing_to_be_had(served: Served, tmp_path: Path) -> None:
    (tmp_path / "files" / "link").symlink_to("/etc/passwd")
    (tmp_path / "files" / "real").touch()
    assert served.list(b"/files") == ["S", "Freal\t0"]


def test_a_file_that_grows_ends_where_it_ended_when_opened(served: Served, tmp_path: Path) -> None:
    (tmp_path / "logs").mkdir()
    log = tmp_path / "logs" / "00001.bin"
    log.write_bytes(TEXT)
    session = served.ask(Opcode.OPEN_FILE_RO, b"/logs/00001.bin").session
    log.write_bytes(TEXT * 400)
    *blocks, end = served.send(request_of(10, Opcode.BURST_READ_FILE, session=session, size=239))
    assert b"".join(block.data for block in blocks) == TEXT
    assert end.offset == len(TEXT)


def test_a_file_that_shrinks_ends_there_without_a_fault(served: Served, tmp_path: Path) -> None:
    served.put(b"/files/a", bytes(600_000))
    session = served.ask(Opcode.OPEN_FILE_RO, b"/files/a").session
    os.truncate(tmp_path / "files" / "a", 10)
    assert served.ask(Opcode.READ_FILE, session=session, offset=500_000, size=239).code is Code.END_OF_FILE
