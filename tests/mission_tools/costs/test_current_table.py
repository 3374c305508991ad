"""Archives that hold no current are refused with a reason, whatever is wrong in them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from companion.core.errors import ConfigError
from mission_tools.costs.current_file import read_current_table

AXIS = np.arange(3.0)
SHEET = np.zeros((3, 3))


def saved(path: Path, **changed: npt.ArrayLike) -> Path:
    arrays: dict[str, Any] = {
        "east_m": AXIS,
        "north_m": AXIS,
        "current_east_m_s": SHEET,
        "current_north_m_s": SHEET,
    }
    np.savez_compressed(path, **(arrays | changed))
    return path


def test_arrays_of_whole_numbers_and_arrays_that_are_not_asked_for_are_no_trouble(tmp_path: Path) -> None:
    path = saved(tmp_path / "forecast.npz", east_m=np.arange(3), source=np.array(["a model"]))
    assert read_current_table(path).east_m.tolist() == [0.0, 1.0, 2.0]


def test_times_are_seconds_or_dates(tmp_path: Path) -> None:
    sheets = np.zeros((2, 3, 3))
    parts = {"current_east_m_s": sheets, "current_north_m_s": sheets}
    times = np.array(["2026-06-01T08:00", "2026-06-01T09:00"], dtype="datetime64[m]")
    dated = read_current_table(saved(tmp_path / "dated.npz", time_utc=times, **parts))
    assert (dated.time_s.tolist(), dated.is_dated) == ([1780300800.0, 1780304400.0], True)
    plain = read_current_table(saved(tmp_path / "plain.npz", time_s=np.array([0, 60]), **parts))
    assert (plain.time_s.tolist(), plain.is_dated) == ([0.0, 60.0], False)
    with pytest.raises(ConfigError, match="not a current"):
        read_current_table(saved(tmp_path / "odd.npz", time_utc=np.array([0.5, 60.5]), **parts))


HEAD = "east_m,north_m,current_east_m_s,current_north_m_s,"


def test_a_table_has_every_point_at_every_time_in_any_order(tmp_path: Path) -> None:
    path = tmp_path / "tide.csv"
    rows = [f"{e},{n},{t + e},{n},{t}" for t in (60, 0) for e in (5, 0) for n in (0, 7)]
    path.write_text("\n".join([HEAD + "time_s", *rows]))
    table = read_current_table(path)
    assert (table.time_s.tolist(), table.is_dated) == ([0.0, 60.0], False)
    assert table.current_east_m_s[1].tolist() == [[60.0, 65.0], [60.0, 65.0]]
    assert table.current_north_m_s[0].tolist() == [[0.0, 0.0], [7.0, 7.0]]
    path.write_text(
        "\n".join([HEAD + "time_utc", "0,0,1,2,2026-06-01T08:00Z", "0,0,3,4,2026-06-01T10:00+01:00"])
    )
    table = read_current_table(path)
    assert (table.time_s.tolist(), table.is_dated) == ([1780300800.0, 1780304400.0], True)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["time_s", "0,0,1,2,soon"], "line 2: expected four numbers and time_s"),
        (["time_utc", "0,0,1,2,7"], "line 2: expected four numbers and time_utc"),
        (["time_utc", "0,0,1,2"], "line 2: expected four numbers and time_utc"),
        (["time_s", "0,0,1,2,0", "0,0,1,2,0"], "comes twice"),
        (["time_s", "0,0,1,2,0", "1,0,1,2,0", "0,0,1,2,9"], "3 points are no grid of 2 × 1 at 2 times"),
        (["time_s", "0,0,1,2,nan"], "time_s: expected a row of rising numbers"),
    ],
)
def test_a_table_with_odd_times_is_refused(tmp_path: Path, lines: list[str], message: str) -> None:
    path = tmp_path / "tide.csv"
    path.write_text(HEAD + "\n".join(lines))
    with pytest.raises(ConfigError, match=message):
        read_current_table(path)


def damaged(path: Path) -> None:
    text = bytearray(saved(path).read_bytes())
    text[60:75] = bytes([255] * 15)
    path.write_bytes(text)


def encrypted(path: Path) -> None:
    text = bytearray(saved(path).read_bytes())
    text[6] |= 1
    text[text.index(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(text)


def one_array(path: Path) -> None:
    with path.open("wb") as file:
        np.save(file, AXIS)


@pytest.mark.parametrize(
    "write",
    [
        lambda path: path.write_bytes(b""),
        damaged,
        encrypted,
        one_array,
        lambda path: saved(path, east_m=1j * AXIS),
        lambda path: saved(path, east_m=np.array(["a", "b", "c"])),
        lambda path: saved(path, east_m=np.array([None, 1, 2])),
        lambda path: saved(path, current_east_m_s=AXIS),
    ],
    ids=["empty", "damaged", "encrypted", "one array", "complex", "words", "objects", "flat"],
)
def test_what_is_no_current_is_refused(tmp_path: Path, write: Callable[[Path], object]) -> None:
    path = tmp_path / "forecast.npz"
    write(path)
    with pytest.raises(ConfigError, match=r"forecast\.npz: not a current: ."):
        read_current_table(path)
