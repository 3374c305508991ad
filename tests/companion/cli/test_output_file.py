"""Files that a program writes for its user: whole under their name, or not there."""

import os
from pathlib import Path

import pytest

from companion.cli.output_file import output_file, write_text
from companion.core.errors import OutputError

FULL = Path("/dev/full")


def test_a_file_gets_its_name_once_it_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "new" / "a.csv"
    with output_file(path) as aside:
        aside.write_text("whole")
        assert not path.exists()
        assert aside.suffix == ".csv"  # what chooses a picture's format
    assert path.read_text() == "whole"
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt(), ValueError()])
def test_a_write_that_breaks_off_leaves_the_old_file_and_no_other(
    tmp_path: Path, error: BaseException
) -> None:
    path = tmp_path / "a.csv"
    path.write_text("old")
    expected = OutputError if isinstance(error, OSError) else type(error)

    def break_off() -> None:
        with output_file(path) as aside:
            aside.write_text("hal")
            raise error

    with pytest.raises(expected):
        break_off()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_stays_one(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("goal")
    write_text(tmp_path / "link", "x")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "goal").read_text() == "x"


@pytest.mark.skipif(not FULL.exists(), reason="no /dev/full on this system")
def test_a_device_is_written_to_and_never_replaced() -> None:
    with pytest.raises(OutputError, match="/dev/full: cannot be written: No space left on device"):
        write_text(FULL, "x")
    assert FULL.is_char_device()
    write_text(Path(os.devnull), "x")
    assert Path(os.devnull).is_char_device()
