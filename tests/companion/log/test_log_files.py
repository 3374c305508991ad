"""Workers, sinks and readers: what stands between the control loop and the medium."""

import errno
import threading
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from late_worker import LateWorker
from patience import MOMENT_S

from companion.core.errors import StorageError
from companion.core.storage import InlineExecutor
from companion.log.reader import BLOCK_BYTES, LogReader
from companion.log.sink import FileSink, SingleFile, Worker
from companion.log.store import LogStore


def test_a_thread_does_jobs_in_order_and_close_waits_for_all_of_them() -> None:
    worker, done = Worker(), []
    for number in range(500):
        assert worker.submit(lambda number=number: done.append((number, threading.current_thread().name)))  # type: ignore[misc]
    worker.close()
    worker.close()
    assert done == [(number, "log_0") for number in range(500)]
    assert not worker.submit(lambda: None)


def test_no_more_bytes_wait_than_allowed_and_room_comes_back() -> None:
    worker, gate = Worker(most_bytes=100, most_jobs=6), threading.Event()
    worker.submit(gate.wait)  # type: ignore[arg-type]
    assert worker.submit(lambda: None, 60)
    assert not worker.submit(lambda: None, 41)
    assert worker.submit(lambda: None, 40)
    assert worker.room_bytes == 0
    after = threading.Event()
    assert worker.submit(after.set)  # what holds no bytes still goes
    assert not all(worker.submit(lambda: None) for _ in range(6)), "nor more jobs"
    gate.set()
    assert after.wait(MOMENT_S)
    assert worker.submit(lambda: None, 100)
    worker.close()
    assert worker.room_bytes == 100


def test_a_job_that_goes_wrong_takes_no_other_with_it(caplog: pytest.LogCaptureFixture) -> None:
    worker, done = Worker(), []
    worker.submit(lambda: done.append(1 // 0))
    worker.submit(lambda: done.append(1))
    worker.close()
    assert done == [1]
    assert "went wrong" in caplog.text


def test_a_sink_makes_one_file_after_the_other(tmp_path: Path) -> None:
    store = LogStore(tmp_path, 100.0)
    sink = FileSink(store, Worker(InlineExecutor()))
    for content in (b"one", b"two"):
        assert sink.begin()
        assert sink.write(content, 1.8e9)
        assert sink.write(b"!", 1.8e9)
        assert (tmp_path / store.files[-1].name).read_bytes() == content + b"!", (
            "on the medium before the end"
        )
        sink.end()
    assert (tmp_path / "00001.bin").read_bytes() == b"one!"
    assert (tmp_path / "00002.bin").read_bytes() == b"two!"
    assert [(file.size_bytes, file.unix_s) for file in store.files] == [(4, 1.8e9)] * 2
    assert sink.fault == ""


class FullFile:
    """A medium with room for so many bytes."""

    def __init__(self, room: int) -> None:
        self.content = b""
        self.is_closed = False
        self._room = room

    def write(self, block: bytes | memoryview) -> int:
        taken = bytes(block)[: self._room - len(self.content)]
        if not taken:
            raise OSError(errno.ENOSPC, "No space left on device")
        self.content += taken
        return len(taken)

    def fileno(self) -> int:
        raise OSError(errno.EIO, "no descriptor")

    def close(self) -> None:
        self.is_closed = True


def test_a_full_medium_is_a_fault_and_the_file_is_let_go(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store, file = LogStore(tmp_path, 100.0), FullFile(10)
    monkeypatch.setattr(store, "create", lambda suffix: ("00001.bin", file))
    sink = FileSink(store, Worker(InlineExecutor()))
    sink.begin()
    assert sink.write(b"12345678", 0.0)
    assert sink.fault == ""
    sink.write(b"12345678", 0.0)
    assert sink.fault == "00001.bin: No space left on device"
    assert (file.content, file.is_closed) == (b"1234567812", True)
    sink.write(b"more", 0.0)
    assert file.content == b"1234567812"
    sink.begin()
    assert sink.fault == ""  # a new log, a new chance


def test_blocks_reach_the_medium_by_fours_and_at_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    flushed: list[int] = []
    monkeypatch.setattr("os.fsync", flushed.append)
    sink = FileSink(LogStore(tmp_path, 100.0), Worker(InlineExecutor()))
    sink.begin()
    for _ in range(5):
        sink.write(b"block", 0.0)
    assert len(flushed) == 1
    sink.end()
    assert len(flushed) == 2


def test_a_log_that_cannot_be_begun_is_a_fault(tmp_path: Path) -> None:
    sink = FileSink(LogStore(tmp_path, 100.0, min_free_mb=1e9), Worker(InlineExecutor()))
    assert sink.begin()
    assert "must stay free" in sink.fault
    sink.write(b"x", 0.0)
    sink.end()


def test_a_single_file_holds_every_log_of_a_run(tmp_path: Path) -> None:
    sink = SingleFile(tmp_path / "new" / "run.bin")
    for content in (b"one", b"two"):
        assert sink.begin()
        assert sink.write(content, 0.0)
        sink.end()
    assert (tmp_path / "new" / "run.bin").read_bytes() == b"onetwo"
    sink.close()
    sink.close()
    with pytest.raises(StorageError, match="cannot be written"):
        SingleFile(tmp_path)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
@pytest.mark.parametrize("size", [1, 100_000])
def test_a_single_file_on_a_full_disk_is_a_fault_whenever_it_is_noticed_and_never_raises(size: int) -> None:
    sink = SingleFile(Path("/dev/full"))
    sink.begin()
    sink.write(bytes(size), 0.0)  # a little waits in memory until the log ends
    sink.end()
    assert sink.fault.startswith("/dev/full: cannot be written: No space left on device")
    assert not sink.write(b"more", 0.0)
    sink.end()
    sink.close()
    sink.close()


def test_a_log_of_which_nothing_could_be_written_is_not_left_lying_about(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = LogStore(tmp_path, 100.0)
    sink = FileSink(store, Worker(InlineExecutor()))
    sink.begin()
    assert sink._file is not None
    sink._file.close()
    monkeypatch.setattr(sink, "_file", FullFile(0))
    sink.write(b"x", 0.0)
    assert sink.fault == "00001.bin: No space left on device"
    assert [one.name for one in tmp_path.iterdir()] == ["LASTLOG.TXT"]
    assert store.files == ()


@given(
    size=st.one_of(st.integers(0, 300), st.integers(2 * BLOCK_BYTES - 99, 2 * BLOCK_BYTES + 99)),
    wanted=st.lists(st.tuples(st.integers(0, 3 * BLOCK_BYTES), st.integers(0, 200)), max_size=20),
    is_late=st.booleans(),
)
def test_pieces_are_those_of_the_file_whatever_is_asked_for(
    tmp_path_factory: pytest.TempPathFactory,
    size: int,
    wanted: list[tuple[int, int]],
    is_late: bool,
) -> None:
    folder = tmp_path_factory.mktemp("logs")
    content = bytes(number * 31 & 0xFF for number in range(size))
    (folder / "00001.bin").write_bytes(content)
    late, inline = LateWorker(), Worker(InlineExecutor())
    reader = LogReader(LogStore(folder, 100.0), late if is_late else inline, "00001.bin")
    for offset, count in wanted:
        piece = reader.piece(offset, count)
        for _ in range(3):
            if piece is not None:
                break
            assert is_late
            late.work()
            piece = reader.piece(offset, count)
        assert piece == content[offset : offset + count]
        assert len(reader._blocks) <= 4


def test_the_next_block_is_read_ahead(tmp_path: Path) -> None:
    content = bytes(BLOCK_BYTES) + b"next"
    (tmp_path / "00001.bin").write_bytes(content)
    worker = LateWorker()
    reader = LogReader(LogStore(tmp_path, 100.0), worker, "00001.bin")
    assert reader.piece(0, 90) is None
    worker.work()
    assert reader.piece(BLOCK_BYTES, 90) == b"next"


def test_a_file_that_grows_is_read_anew(tmp_path: Path) -> None:
    path = tmp_path / "00001.bin"
    path.write_bytes(b"begin")
    reader = LogReader(LogStore(tmp_path, 100.0), Worker(InlineExecutor()), "00001.bin")
    assert reader.piece(0, 90) == b"begin"
    path.write_bytes(b"begin and more")
    reader.refresh()
    assert reader.piece(0, 90) == b"begin and more"


def test_a_file_that_is_gone_reads_as_empty(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "00001.bin"
    path.write_bytes(b"begin")
    store = LogStore(tmp_path, 100.0)
    path.unlink()
    assert LogReader(store, Worker(InlineExecutor()), "00001.bin").piece(0, 90) == b""
    assert "cannot be read" in caplog.text


def test_a_read_that_finds_no_room_is_asked_for_again(tmp_path: Path) -> None:
    (tmp_path / "00001.bin").write_bytes(b"begin")
    worker = LateWorker(most_jobs=0)
    reader = LogReader(LogStore(tmp_path, 100.0), worker, "00001.bin")
    assert reader.piece(0, 90) is None
    worker._most_jobs = 10
    assert reader.piece(0, 90) is None
    worker.work()
    assert reader.piece(0, 90) == b"begin"
