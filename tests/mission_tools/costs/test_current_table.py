"""Archives that hold no current are refused with a reason, whatever is wrong in them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from companion.core.errors import ConfigError
from mission_tools.costs.current import read_current_table

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
