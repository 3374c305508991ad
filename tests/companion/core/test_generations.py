"""Files on a medium that decays, and writes that a power cut ends anywhere."""

import errno
import os
import threading
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from patience import MOMENT_S

from companion.core.errors import StorageError
from companion.core.generations import (
    DamagedError,
    Generation,
    find_newest,
    save_next,
    seal,
    unseal,
    write_atomically,
)
from companion.core.storage import FolderStorage, Saving
from companion.mavlink.signing_key import SigningKey, read_key_file

NAME = "fence.json"
FIRST, SECOND, THIRD = b"the first", b"the second, which is longer", b"the third"


def saved(folder: Path, *contents: bytes) -> Path:
    """A file that has been saved with one content after the other."""
    for content in contents:
        save_next(folder / NAME, content, write_atomically)
    return folder / NAME


def loaded(folder: Path) -> tuple[bytes, str]:
    storage = FolderStorage(folder)
    content = storage.load(NAME)
    return content, storage.damage(NAME)


@given(st.integers(0, 10**18 - 1), st.binary(max_size=300), st.integers(0), st.integers(1, 2**32 - 1))
@example(100, b"\x01" * 11, 376, 120)  # the end of a line in the middle of the first one
def test_what_is_sealed_is_read_back_and_any_burst_of_32_bits_is_noticed(
    number: int, content: bytes, at: int, burst: int
) -> None:
    whole = seal(Generation(number, content))
    assert unseal(whole) == Generation(number, content)
    value = int.from_bytes(whole, "big") ^ burst << at % (8 * len(whole) - 31)
    with pytest.raises(DamagedError):
        unseal(value.to_bytes(len(whole), "big"))


def test_each_save_is_one_generation_later_and_the_one_before_is_kept(tmp_path: Path) -> None:
    path = saved(tmp_path, FIRST, SECOND, THIRD)
    assert unseal(path.read_bytes()) == Generation(3, THIRD)
    assert unseal((tmp_path / f"{NAME}.old").read_bytes()) == Generation(2, SECOND)
    assert sorted(one.name for one in tmp_path.iterdir()) == [NAME, f"{NAME}.old"]


@pytest.mark.parametrize("file", [b"", b"\x00" * 80, b"# mavboat gen", seal(Generation(2, SECOND))[:-1]])
def test_what_a_crashed_file_system_leaves_is_no_content(tmp_path: Path, file: bytes) -> None:
    path = saved(tmp_path, FIRST, SECOND)
    path.write_bytes(file)
    assert loaded(tmp_path) == (FIRST, "fence.json is damaged, the previous one is in use")
    path.with_name(f"{NAME}.old").write_bytes(file)
    assert loaded(tmp_path) == (b"", "fence.json is damaged, there is no previous one")
    path.unlink()
    assert loaded(tmp_path) == (b"", "fence.json is damaged, there is no previous one")


def test_a_block_that_cannot_be_read_is_damage_and_a_file_that_may_not_be_read_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = saved(tmp_path, FIRST, SECOND)
    real, numbers = Path.read_bytes, [errno.EIO, errno.EACCES]

    def read(one: Path) -> bytes:
        if one == path:
            raise OSError(numbers[0], "no")
        return real(one)

    monkeypatch.setattr(Path, "read_bytes", read)
    assert find_newest(path).generation.content == FIRST
    del numbers[0]
    with pytest.raises(OSError, match="no"):
        find_newest(path)


def test_a_damaged_generation_never_replaces_the_whole_one_before_it(tmp_path: Path) -> None:
    path = saved(tmp_path, FIRST, SECOND)
    path.write_bytes(b"\x00")
    saved(tmp_path, THIRD)
    assert unseal(path.with_name(f"{NAME}.old").read_bytes()).content == FIRST
    assert loaded(tmp_path) == (THIRD, "")


CUTS = ["nothing is done", "a part is aside", "all is aside", "the newest is kept", "all is done"]


@pytest.mark.parametrize("cut", CUTS)
def test_a_power_cut_at_any_step_of_a_write_leaves_the_newest_whole_generation(
    tmp_path: Path, cut: str
) -> None:
    path = saved(tmp_path, FIRST, SECOND)
    aside, step = path.with_name(f"{NAME}.new"), CUTS.index(cut)
    new = seal(Generation(3, THIRD))
    if step >= 1:
        aside.write_bytes(new[:-4] if step == 1 else new)
    if step >= 3:
        path.replace(path.with_name(f"{NAME}.old"))
    if step >= 4:
        aside.replace(path)
    content = THIRD if step >= 2 else SECOND
    assert loaded(tmp_path) == (content, "")
    # Neither is it lost when power goes again during the next write
    with pytest.raises(KeyboardInterrupt):
        save_next(path, b"the fourth", cut_in_the_middle)
    assert loaded(tmp_path) == (content, "")
    saved(tmp_path, b"the fifth")
    assert loaded(tmp_path) == (b"the fifth", "")


def cut_in_the_middle(path: Path, content: bytes, keep: Path | None) -> None:
    """Power goes while the content is written aside."""
    path.with_name(f"{path.name}.new").write_bytes(content[:10])
    raise KeyboardInterrupt


def test_a_medium_that_refuses_leaves_the_old_generations_and_no_part_of_the_new(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = saved(tmp_path, FIRST, SECOND)
    before = {one.name: one.read_bytes() for one in tmp_path.iterdir()}

    def full(number: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OSError, match="No space left"):
        save_next(path, THIRD, write_atomically)
    assert {one.name: one.read_bytes() for one in tmp_path.iterdir()} == before


def test_a_file_that_somebody_puts_there_counts_before_what_was_saved(tmp_path: Path) -> None:
    path = saved(tmp_path, FIRST, SECOND)
    path.write_bytes(THIRD)
    assert loaded(tmp_path) == (THIRD, "")
    saved(tmp_path, FIRST)
    assert unseal(path.read_bytes()).number == 2
    assert unseal(path.with_name(f"{NAME}.old").read_bytes()).content == THIRD


def test_both_generations_of_a_key_are_its_owners_alone_and_a_key_file_as_any(tmp_path: Path) -> None:
    path, keys = tmp_path / "signing.key", [SigningKey(bytes([n] * 32)) for n in (1, 2)]
    for key in keys:
        save_next(path, key.reveal().hex().encode(), write_atomically)
    assert [read_key_file(path), read_key_file(path.with_name("signing.key.old"))] == keys[::-1]


OLD, NEW = b"the old list", b"the new list, which is longer"


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


def test_a_folder_that_cannot_be_used_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(StorageError, match="file"):
        FolderStorage(tmp_path / "file")
    (tmp_path / "state" / "mission.json").mkdir(parents=True)
    with pytest.raises(StorageError, match=r"mission\.json"):
        FolderStorage(tmp_path / "state").load("mission.json")
