"""The jail: whatever path a station sends, nothing outside the folder is read, changed or even seen."""

import os
from pathlib import Path

import pytest
from ftp_client import ACK, Served
from hypothesis import example, given
from hypothesis import strategies as st

from companion.mavlink.ftp_frames import Opcode, Refusal
from companion.services.ftp.folder import FolderMount
from companion.services.ftp.tree import DirectoryEntry, page_of, split_path

SECRET = b"what nobody may have"
WITH_PATH = [
    Opcode.LIST_DIRECTORY, Opcode.OPEN_FILE_RO, Opcode.CREATE_FILE, Opcode.REMOVE_FILE,
    Opcode.CREATE_DIRECTORY, Opcode.REMOVE_DIRECTORY, Opcode.OPEN_FILE_WO, Opcode.TRUNCATE_FILE,
    Opcode.RENAME, Opcode.CALC_FILE_CRC32,
]  # fmt: skip
PIECES = st.sampled_from(
    [b"..", b".", b"", b"files", b"logs", b"@LOGS", b"out", b"secret", b"deep", b"loop", b"pipe", b"\0",
     b"\xff", b"etc", b"passwd", b"%2e%2e", b"..\\", b"~", b"a" * 230, b"\n"]
)  # fmt: skip
PATHS = st.lists(PIECES, max_size=8).map(b"/".join).map(lambda path: path[:239])


def prison(folder: Path) -> Served:
    """A boat whose folders are full of ways out."""
    boat = folder / "boat"
    served = Served(boat)
    (folder / "secret").write_bytes(SECRET)
    (boat / "params.parm").write_bytes(SECRET)
    (boat / "logs").mkdir()
    for inside in (boat / "files", boat / "logs"):
        (inside / "out").symlink_to(folder)
        (inside / "secret").symlink_to(folder / "secret")
        (inside / "deep").mkdir()
        (inside / "deep" / "out").symlink_to("../../..")
        (inside / "loop").symlink_to("loop")
        os.mkfifo(inside / "pipe")
    return served


def outside(folder: Path) -> dict[str, bytes]:
    """Everything that a station must not touch."""
    boat = folder / "boat"
    jail = {boat / "files"}
    found = {}
    for root, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if Path(root, name) not in jail]
        for name in files:
            path = Path(root, name)
            found[str(path)] = path.read_bytes() if path.is_file() and not path.is_symlink() else b""
    return found


@given(opcode=st.sampled_from(WITH_PATH), path=PATHS, other=PATHS)
@example(opcode=Opcode.RENAME, path=b"/files/secret", other=b"/logs/x")
@example(opcode=Opcode.OPEN_FILE_RO, path=b"/files/out/secret", other=b"")
@example(opcode=Opcode.OPEN_FILE_RO, path=b"/files/pipe", other=b"")
@example(opcode=Opcode.OPEN_FILE_RO, path=b"/files/loop", other=b"")
@example(opcode=Opcode.REMOVE_FILE, path=b"/files/deep/out/secret", other=b"")
@example(opcode=Opcode.OPEN_FILE_RO, path=b"/files/../params.parm", other=b"")
@example(opcode=Opcode.OPEN_FILE_RO, path=b"//etc/passwd", other=b"")
def test_no_path_leads_out(
    tmp_path_factory: pytest.TempPathFactory, opcode: Opcode, path: bytes, other: bytes
) -> None:
    folder = tmp_path_factory.mktemp("prison")
    served = prison(folder)
    before = outside(folder)
    data = (path + b"\0" + other if opcode is Opcode.RENAME else path)[:239]
    reply = served.ask(opcode, data)
    assert SECRET not in reply.data
    if reply.opcode == ACK:
        if opcode is Opcode.OPEN_FILE_RO:
            assert SECRET not in served.ask(Opcode.READ_FILE, session=reply.session, size=239).data
        if opcode in (Opcode.CREATE_FILE, Opcode.OPEN_FILE_WO):
            served.ask(Opcode.WRITE_FILE, b"mine", reply.session)
            served.ask(Opcode.TERMINATE_SESSION, session=reply.session)
    assert outside(folder) == before


def test_a_link_put_in_the_way_of_an_upload_is_replaced_and_not_followed(tmp_path: Path) -> None:
    served = prison(tmp_path)
    session = served.ask(Opcode.CREATE_FILE, b"/files/new").session
    served.ask(Opcode.WRITE_FILE, b"mine", session)
    (tmp_path / "boat" / "files" / "new").symlink_to(tmp_path / "secret")
    assert served.ask(Opcode.TERMINATE_SESSION, session=session).opcode == ACK
    assert (tmp_path / "secret").read_bytes() == SECRET
    assert (tmp_path / "boat" / "files" / "new").read_bytes() == b"mine"


@given(path=st.binary(max_size=239))
def test_a_path_comes_to_pieces_that_are_plain_names(path: bytes) -> None:
    try:
        names = split_path(path)
    except Refusal:
        return
    for name in names:
        assert name not in ("", ".", "..")
        assert not set(name) & {"/", "\0"}
        assert len(name.encode()) <= 239
    assert len(names) <= 16


@given(
    entries=st.lists(
        st.builds(DirectoryEntry, st.text(min_size=1, max_size=250), st.none() | st.integers(-1, 2**40)),
        max_size=40,
    )
)
def test_pages_hold_every_entry_once_and_fit_a_block(entries: list[DirectoryEntry]) -> None:
    seen = 0
    while seen < len(entries):
        page = page_of(entries, seen)
        assert 0 < len(page) <= 239
        assert {line[:1] for line in page[:-1].split(b"\0")} <= {b"F", b"D", b"S"}
        seen += page.count(b"\0")
    assert seen == len(entries)
    with pytest.raises(Refusal, match="END_OF_FILE"):
        page_of(entries, seen)


def test_the_owner_may_put_the_folder_elsewhere_by_a_link(tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    (tmp_path / "disk" / "a").write_bytes(b"here")
    (tmp_path / "files").symlink_to(tmp_path / "disk")
    reading = FolderMount(tmp_path / "files", quota_bytes=100).open(("a",))
    assert reading.read(0, 10) == b"here"
    reading.close()
    reading.close()


def test_a_reading_ends_where_its_file_ended_when_it_was_opened(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"0123456789")
    reading = FolderMount(tmp_path).open(("a",))
    (tmp_path / "a").write_bytes(b"0123456789" * 5)
    assert (reading.fetch(4, 100), reading.fetch(9, 5)) == (b"456789", b"9")
    reading.close()
    assert reading.fetch(0, 5) == b""
