"""What stations may leave on the boat's disk: bytes, entries and depth."""

import errno
import os
from pathlib import Path
from typing import Any

import pytest
from ftp_client import ACK, Served
from hypothesis import example, given
from hypothesis import strategies as st

from companion.mavlink.ftp_frames import Code, Opcode, Refusal
from companion.services.ftp.folder import FolderMount
from companion.services.ftp.quota import MOST_ENTRIES, Quota
from companion.services.ftp.tree import MAX_DEPTH, Names

QUOTA_BYTES = 1000


@pytest.fixture
def mount(tmp_path: Path) -> FolderMount:
    return FolderMount(tmp_path / "files", quota_bytes=QUOTA_BYTES)


def test_empty_files_and_folders_come_to_an_end(tmp_path: Path) -> None:
    (tmp_path / "files" / "folder").mkdir(parents=True)
    for number in range(MOST_ENTRIES - 3):
        (tmp_path / "files" / "folder" / str(number)).touch()
    served = Served(tmp_path, quota_mb=0.001)
    assert served.put(b"/files/a", b"").opcode == ACK
    assert served.ask(Opcode.CREATE_DIRECTORY, b"/files/d").opcode == ACK
    for refused in (Opcode.CREATE_DIRECTORY, Opcode.CREATE_FILE):
        assert served.ask(refused, b"/files/more").code is Code.FAIL_ERRNO
    assert served.put(b"/files/a", b"x").opcode == ACK
    assert served.ask(Opcode.REMOVE_DIRECTORY, b"/files/d").opcode == ACK
    assert served.ask(Opcode.CREATE_DIRECTORY, b"/files/more").opcode == ACK
    assert MOST_ENTRIES == 1000


def test_a_file_is_replaced_by_one_of_its_size_however_full_the_quota_is(mount: FolderMount) -> None:
    mount.save(("a",), bytes(600))
    mount.save(("a",), bytes(600))
    mount.save(("a",), bytes(QUOTA_BYTES))
    with pytest.raises(OSError, match="quota"):
        mount.save(("a",), bytes(QUOTA_BYTES + 1))
    with pytest.raises(OSError, match="quota"):
        mount.save(("b",), b"x")
    mount.save(("b",), b"")
    mount.save(("a",), b"")
    mount.save(("b",), bytes(QUOTA_BYTES))
    mount.truncate(("b",), 300)
    assert mount._quota._bytes == 300


def test_the_folder_is_not_walked_for_every_save(mount: FolderMount, monkeypatch: pytest.MonkeyPatch) -> None:
    walks: list[object] = []
    real = os.fwalk

    def walk(*args: Any, **kwargs: Any) -> Any:  # noqa: ANN401
        walks.append(args)
        return real(*args, **kwargs)

    monkeypatch.setattr(os, "fwalk", walk)
    for number in range(50):
        mount.save((str(number),), bytes(20))
        mount.save((str(number),), bytes(19))
    assert len(walks) == 1


def test_renames_do_not_nest_folders_deeper_than_a_path_leads(mount: FolderMount, tmp_path: Path) -> None:
    for number in range(MAX_DEPTH * 2):
        mount.make_folder((f"d{number}",))
    deepest: Names = ("d0",)
    with pytest.raises(OSError, match="too deep"):  # noqa: PT012  where exactly is asserted below
        for number in range(1, MAX_DEPTH * 2):
            mount.rename(deepest[:1], (f"d{number}", "in"))
            deepest = (f"d{number}",)
    depth = max(len(Path(root).relative_to(tmp_path).parts) for root, _, _ in os.walk(tmp_path / "files"))
    assert depth == MAX_DEPTH == 16  # `files` is one of the names


def test_a_full_disk_keeps_the_old_file_and_no_part_of_the_new(
    mount: FolderMount, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mount.save(("a",), b"old")

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        mount.save(("a",), b"new")
    monkeypatch.undo()
    assert mount.open(("a",)).read(0, 9) == b"old"
    assert [one.name for one in tmp_path.rglob("*")] == ["files", "a"]


OPERATIONS = st.lists(
    st.tuples(
        st.sampled_from(["save", "truncate", "remove", "folder", "remove folder", "rename"]),
        st.sampled_from(["a", "b", "c"]),
        st.sampled_from(["a", "b", "d"]),
        st.integers(0, 60),
    ),
    max_size=40,
)


@given(OPERATIONS)
@example([("save", "a", "a", 5), ("save", "b", "a", 5), ("remove", "a", "a", 0)])
def test_what_is_kept_up_is_what_a_count_finds(
    tmp_path_factory: pytest.TempPathFactory, operations: list[tuple[str, str, str, int]]
) -> None:
    folder = tmp_path_factory.mktemp("boat") / "files"
    mount = FolderMount(folder, quota_bytes=100)
    for what, name, other, size in operations:
        try:
            match what:
                case "save":
                    mount.save((name,), bytes(size))
                case "truncate":
                    mount.truncate((name,), size)
                case "remove":
                    mount.remove((name,))
                case "folder":
                    mount.make_folder((name,))
                case "remove folder":
                    mount.remove_folder((name,))
                case _:
                    mount.rename((name,), (other, name) if size % 2 else (other,))
        except (OSError, Refusal):
            pass
    counted = Quota(folder, 100)
    counted._count()
    if mount._quota._is_counted:
        assert (mount._quota._bytes, mount._quota._entries) == (counted._bytes, counted._entries)
    assert counted._bytes <= 100


def test_a_file_moves_as_deep_as_a_path_leads(mount: FolderMount) -> None:
    folder: Names = ()
    for _ in range(MAX_DEPTH - 2):
        folder = (*folder, "d")
        mount.make_folder(folder)
    mount.save(("a",), b"x")
    mount.rename(("a",), (*folder, "a"))
    assert mount.open((*folder, "a")).read(0, 9) == b"x"
    mount.make_folder(("e",))
    mount.save(("e", "f"), b"")
    with pytest.raises(OSError, match="too deep"):
        mount.rename(("e",), (*folder, "e"))
