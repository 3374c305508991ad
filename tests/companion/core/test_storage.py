import os
import threading
from pathlib import Path

import pytest
from patience import MOMENT_S

from companion.core.errors import StorageError
from companion.core.generations import unseal, write_atomically
from companion.core.storage import FolderStorage, Saving

OLD, NEW = b"the old list", b"the new list, which is longer"


def test_what_was_saved_is_loaded(tmp_path: Path) -> None:
    storage = FolderStorage(tmp_path / "deep" / "state")
    assert storage.load("mission.json") == b""
    saving = storage.save("mission.json", OLD)
    storage.close()
    assert saving.is_done()
    assert saving.error() == ""
    assert FolderStorage(tmp_path / "deep" / "state").load("mission.json") == OLD


def test_the_content_is_on_the_medium_before_the_name_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[str] = []
    real_fsync, real_replace = os.fsync, Path.replace

    def fsync(number: int) -> None:
        done.append("fsync")
        real_fsync(number)

    def replace(path: Path, target: Path) -> Path:
        done.append("replace")
        return real_replace(path, target)

    monkeypatch.setattr(os, "fsync", fsync)
    monkeypatch.setattr(Path, "replace", replace)
    write_atomically(tmp_path / "a", NEW)
    assert done == ["fsync", "replace", "fsync"]


@pytest.mark.parametrize(
    ("fault", "words"), [(OSError(28, "disk full"), "disk full"), (OSError(), "OSError")]
)
def test_a_write_that_fails_says_why(tmp_path: Path, fault: OSError, words: str) -> None:
    def refuse(path: Path, content: bytes, keep: Path | None) -> None:
        raise fault

    storage = FolderStorage(tmp_path, refuse)
    saving: Saving = storage.save("mission.json", NEW)
    storage.close()
    assert saving.is_done()
    assert words in saving.error()
    assert storage.load("mission.json") == b""


def test_saves_that_wait_for_the_medium_become_one_for_each_name(tmp_path: Path) -> None:
    written: list[tuple[str, bytes]] = []
    begun, go = threading.Event(), threading.Event()

    def write(path: Path, content: bytes, keep: Path | None) -> None:
        begun.set()
        assert go.wait(MOMENT_S)
        written.append((path.name, unseal(content).content))
        write_atomically(path, content, keep)

    storage = FolderStorage(tmp_path, write)
    savings = [storage.save("params.parm", b"0")]
    assert begun.wait(MOMENT_S)
    savings += [storage.save("params.parm", str(n).encode()) for n in range(1, 200)]
    savings += [storage.save("mission.json", NEW)]
    savings += [storage.save("params.parm", b"200")]
    assert not any(saving.is_done() for saving in savings)
    go.set()
    storage.close()
    assert written == [("params.parm", b"0"), ("params.parm", b"200"), ("mission.json", NEW)]
    assert all(saving.is_done() and not saving.error() for saving in savings)


def test_what_is_being_saved_is_loaded(tmp_path: Path) -> None:
    storage = FolderStorage(tmp_path)
    for n in range(50):
        storage.save("a", str(n).encode())
    assert storage.load("a") == b"49"
    storage.close()


def test_a_folder_that_cannot_be_used_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(StorageError, match="file"):
        FolderStorage(tmp_path / "file")
    (tmp_path / "state" / "mission.json").mkdir(parents=True)
    with pytest.raises(StorageError, match=r"mission\.json"):
        FolderStorage(tmp_path / "state").load("mission.json")
