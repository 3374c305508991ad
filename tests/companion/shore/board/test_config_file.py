"""The configuration file: whole at every moment, with its predecessors, and nothing else of the disk."""

import errno
import os
import stat
from pathlib import Path

import pytest

from companion.core.errors import BoatError, ConfigError, StorageError
from companion.shore.board.config_file import KEPT, MOST_BYTES, ChangedError, ConfigFile, encode


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "boat.toml"
    file.write_text("a = 0\n", encoding="utf-8")
    file.chmod(0o640)
    return file


def write(file: ConfigFile, text: str) -> None:
    file.write(text, file.read().hash)


def test_the_old_text_is_kept_with_its_date_and_the_new_one_has_its_mode(path: Path) -> None:
    os.utime(path, (1e9, 1e9))
    file = ConfigFile(path)
    now = file.write("a = 1 # ü\n", file.read().hash)
    assert now == file.read()
    assert path.read_text("utf-8") == now.text == "a = 1 # ü\n"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert [(one.number, one.time_s) for one in file.kept()] == [(1, 1e9)]
    assert file.read(1).text == "a = 0\n"
    assert sorted(one.name for one in path.parent.iterdir()) == ["boat.toml", "boat.toml.1"]


def test_the_five_latest_are_kept(path: Path) -> None:
    file = ConfigFile(path)
    for number in range(1, 8):
        write(file, f"a = {number}\n")
    assert file.read().text == "a = 7\n"
    assert [file.read(one.number).text for one in file.kept()] == [f"a = {n}\n" for n in (6, 5, 4, 3, 2)]
    assert len(list(path.parent.iterdir())) == 1 + KEPT


def test_the_same_text_again_costs_no_earlier_one(path: Path) -> None:
    file = ConfigFile(path)
    write(file, "a = 0\n")
    assert file.kept() == []


def test_a_file_that_was_changed_meanwhile_is_not_overwritten(path: Path) -> None:
    file = ConfigFile(path)
    read = file.read().hash
    path.write_text("a = 5\n", encoding="utf-8")
    with pytest.raises(ChangedError, match="changed meanwhile"):
        file.write("a = 1\n", read)
    assert path.read_text("utf-8") == "a = 5\n"
    assert file.kept() == []


def test_it_is_on_the_medium_before_it_takes_the_name(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[str] = []
    sync, replace = os.fsync, Path.replace

    def note_sync(number: int) -> None:
        done.append("folder" if stat.S_ISDIR(os.fstat(number).st_mode) else "file")
        sync(number)

    def note_replace(one: Path, other: Path) -> Path:
        done.append(f"-> {other.name}")
        return replace(one, other)

    monkeypatch.setattr(os, "fsync", note_sync)
    monkeypatch.setattr(Path, "replace", note_replace)
    write(ConfigFile(path), "a = 1\n")
    assert done[-6:] == ["file", "-> boat.toml.1", "folder", "file", "-> boat.toml", "folder"]


@pytest.mark.parametrize("steps", range(11))
def test_a_power_cut_at_any_step_leaves_the_old_or_the_new_text(
    path: Path, monkeypatch: pytest.MonkeyPatch, steps: int
) -> None:
    file = ConfigFile(path)
    write(file, "a = 1\n")
    left = steps

    def cut(real: object) -> object:
        def call(*arguments: object, **named: object) -> object:
            nonlocal left
            left -= 1
            if left < 0:
                raise KeyboardInterrupt
            return real(*arguments, **named)  # type: ignore[operator]

        return call

    with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):  # noqa: PT012
        patched.setattr(os, "fsync", cut(os.fsync))
        patched.setattr(Path, "replace", cut(Path.replace))
        file.write("a = 2\n", file.read().hash)
        raise KeyboardInterrupt
    after = file.read().text
    assert after == ("a = 2\n" if steps >= 9 else "a = 1\n")
    write(file, "a = 3\n")
    assert file.read(1).text == after


def test_a_full_disk_changes_nothing(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = ConfigFile(path)

    def full(number: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StorageError, match="No space left"):
        write(file, "a = 1\n")
    assert path.read_text("utf-8") == "a = 0\n"
    assert [one.name for one in path.parent.iterdir()] == ["boat.toml"]


@pytest.mark.parametrize("make", ["missing", "folder", "pipe", "link", "latin", "large"])
def test_what_is_no_text_file_is_refused_with_its_name(tmp_path: Path, make: str) -> None:
    file = ConfigFile(tmp_path / "boat.toml")
    match make:
        case "folder":
            file.path.mkdir()
        case "pipe":
            os.mkfifo(file.path)
        case "link":  # made after the program has begun
            file.path.symlink_to("/etc/passwd")
        case "latin":
            file.path.write_bytes(b"a = '\xfc'\n")
        case "large":
            file.path.write_bytes(b"#" * (MOST_BYTES + 1))
    with pytest.raises(StorageError, match=r"boat\.toml: "):
        file.read()


def test_an_earlier_one_that_is_a_link_is_not_followed(path: Path) -> None:
    (path.parent / "boat.toml.1").symlink_to("/etc/passwd")
    with pytest.raises(StorageError, match="cannot be read"):
        ConfigFile(path).read(1)


@pytest.mark.parametrize("number", [-1, 6])
def test_there_are_no_other_numbers(path: Path, number: int) -> None:
    with pytest.raises(StorageError, match="expected 1 to 5"):
        ConfigFile(path).read(number)


def test_a_link_left_in_the_place_of_the_new_text_is_not_written_through(path: Path, tmp_path: Path) -> None:
    victim = tmp_path / "victim"
    victim.write_text("safe", encoding="utf-8")
    (path.parent / ".boat.toml.new").symlink_to(victim)
    write(ConfigFile(path), "a = 1\n")
    assert victim.read_text("utf-8") == "safe"
    assert path.read_text("utf-8") == "a = 1\n"


@pytest.mark.parametrize("text", ["\ud800", "#" * (MOST_BYTES + 1), "ü" * (MOST_BYTES // 2 + 1)])
def test_a_text_that_is_no_configuration_is_refused(text: str) -> None:
    with pytest.raises(ConfigError) as caught:
        encode(text)
    assert isinstance(caught.value, BoatError)
