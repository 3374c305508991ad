"""The folder of logs: numbers, room, dates."""

import os
from pathlib import Path

import pytest

from companion.core.errors import StorageError
from companion.log.store import LogStore

MB = 1_000_000


def written(store: LogStore, size_bytes: int, suffix: str = ".bin", *, finished: bool = True) -> str:
    """A log of some size."""
    name, file = store.create(suffix)
    file.write(bytes(size_bytes))
    file.close()
    store.grew(name, size_bytes, 1.8e9)
    if finished:
        store.finish(name)
    return name


def names(store: LogStore) -> list[str]:
    """What is listed, which must be what is on the medium."""
    on_disk = sorted(path.name for path in store.folder.iterdir() if path.name != "LASTLOG.TXT")
    listed = [file.name for file in store.files]
    assert sorted(listed) == on_disk
    return listed


def test_logs_are_numbered_and_the_last_number_is_kept_as_ardupilot_keeps_it(tmp_path: Path) -> None:
    store = LogStore(tmp_path / "logs", 100.0)
    assert [written(store, 10) for _ in range(3)] == ["00001.bin", "00002.bin", "00003.bin"]
    assert (tmp_path / "logs" / "LASTLOG.TXT").read_bytes() == b"3\r\n"


def test_a_number_is_never_used_again_even_after_everything_was_erased(tmp_path: Path) -> None:
    store = LogStore(tmp_path, 100.0)
    written(store, 10)
    written(store, 10)
    store.erase()
    assert names(store) == []
    assert written(LogStore(tmp_path, 100.0), 10) == "00003.bin"
    (tmp_path / "00041.bin").write_bytes(b"x")
    (tmp_path / "LASTLOG.TXT").write_bytes(b"\xff nonsense")
    assert written(LogStore(tmp_path, 100.0), 10) == "00042.bin"


def test_the_list_survives_a_restart_and_leaves_foreign_files_alone(tmp_path: Path) -> None:
    store = LogStore(tmp_path, 100.0)
    written(store, 10)
    written(store, 20, "-tcp_127.0.0.1_5760.tlog")
    for name in ("notes.txt", "1.bin", "00001.bin.part", "00003-../x.bin".replace("/", "_")):
        (tmp_path / name).write_bytes(b"mine")
    (tmp_path / "00009.bin").mkdir()
    again = LogStore(tmp_path, 100.0)
    assert [(file.name, file.size_bytes) for file in again.files[:2]] == [
        ("00001.bin", 10), ("00002-tcp_127.0.0.1_5760.tlog", 20)
    ]  # fmt: skip
    assert [file.number for file in again.logs] == [1, 3]
    again.erase()
    assert (tmp_path / "notes.txt").read_bytes() == b"mine"
    assert (tmp_path / "00009.bin").is_dir()


def test_the_oldest_go_first_when_together_they_are_too_large(tmp_path: Path) -> None:
    store = LogStore(tmp_path, 1.0)
    for _ in range(5):
        written(store, 300_000)
    store.make_room()
    assert names(store) == ["00003.bin", "00004.bin", "00005.bin"]


def test_a_new_log_makes_room_first(tmp_path: Path) -> None:
    for _ in range(5):
        written(LogStore(tmp_path, 100.0), 300_000)
    store = LogStore(tmp_path, 1.0)  # the owner has lowered the quota
    written(store, 10, finished=False)
    assert names(store) == ["00003.bin", "00004.bin", "00005.bin", "00006.bin"]


def test_a_log_that_is_being_written_is_never_removed(tmp_path: Path) -> None:
    store = LogStore(tmp_path, 1.0)
    current = written(store, 5 * MB, finished=False)
    other = written(store, MB)
    store.make_room()
    assert names(store) == [current]
    store.erase()
    assert names(store) == [current]
    store.finish(current)
    store.make_room()
    assert names(store) == []
    assert other not in names(store)


def test_a_file_bears_the_boats_date_or_none(tmp_path: Path) -> None:
    store = LogStore(tmp_path, 100.0)
    dated, undated = written(store, 10), written(store, 10)
    store.grew(undated, 10, 0.0)
    store.date(dated)
    store.date(undated)
    assert os.stat(tmp_path / dated).st_mtime == 1.8e9
    assert [file.unix_s for file in LogStore(tmp_path, 100.0).files] == [1.8e9, 0.0]


def test_only_files_of_the_list_can_be_opened(tmp_path: Path) -> None:
    (tmp_path / "secret").write_bytes(b"no")
    store = LogStore(tmp_path / "logs", 100.0)
    name = written(store, 3)
    with store.open(name) as file:
        assert file.read() == bytes(3)
    for other in ("../secret", "00002.bin", "", "/etc/passwd"):
        with pytest.raises(StorageError, match="no such log"):
            store.open(other)
    (tmp_path / "logs" / name).unlink()
    with pytest.raises(StorageError, match="cannot be read"):
        store.open(name)


def test_a_folder_that_cannot_be_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "logs").write_bytes(b"a file")
    with pytest.raises(StorageError, match="cannot be used for logs"):
        LogStore(tmp_path / "logs", 1.0)


def test_a_file_that_cannot_be_removed_stays_listed(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    store = LogStore(tmp_path, 100.0)
    name = written(store, 10)
    (tmp_path / name).unlink()
    (tmp_path / name).mkdir()
    store.erase()
    assert [file.name for file in store.files] == [name]
    assert "cannot be removed" in caplog.text
