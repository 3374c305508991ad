"""Masks that would take long to read are refused by what they really hold, in one line."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from mission_tools.errors import MapError
from mission_tools.maps import crs, load_map
from mission_tools.maps.formats import mask as mask_format

WORLD = "1e-5\n0\n0\n-1e-5\n10\n50\n"


def saved(path: Path, pixels: NDArray[np.bool_], file_bytes: int = 0) -> Path:
    """A picture of one bit a pixel with a world file, filled up to a size behind the picture's end."""
    Image.fromarray(pixels).save(path, **({"compression": "group4"} if path.suffix == ".tif" else {}))
    path.with_suffix(".wld").write_text(WORLD, encoding="ascii")
    data = path.read_bytes()
    assert not file_bytes or len(data) <= file_bytes
    path.write_bytes(data.ljust(file_bytes, b"\0"))
    return path


def refusal(path: Path) -> str:
    with pytest.raises(MapError) as caught:
        load_map(path)
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    assert "\n" not in said
    return said


@pytest.mark.parametrize("name", ["m.png", "m.tif"])
def test_few_bytes_do_not_claim_millions_of_pixels(tmp_path: Path, name: str) -> None:
    """8 million pixels need 1600 bytes; with one less the file is refused before it is unpacked."""
    land = np.zeros((2_000, 4_000), bool)
    said = refusal(saved(tmp_path / name, land, 1_599))
    assert "8000000 pixels in 1599 bytes: at most 5000 a byte above 4 million pixels" in said
    assert "no water in it" in refusal(saved(tmp_path / name, land, 1_600))


def test_up_to_four_million_pixels_are_read_however_few_bytes_hold_them(tmp_path: Path) -> None:
    assert "no water in it" in refusal(saved(tmp_path / "m.png", np.zeros((2_000, 2_000), bool)))
    assert "4002000 pixels in" in refusal(saved(tmp_path / "m.png", np.zeros((2_001, 2_000), bool)))


def test_a_shore_of_too_many_edges_is_refused_before_it_is_contoured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every other row is water, too narrow to remain: 500 edges between two rows."""
    stripes = np.zeros((502, 500), bool)
    stripes[::2] = True
    assert "no water in it" in refusal(saved(tmp_path / "m.png", stripes[:501]))
    monkeypatch.delattr(mask_format, "outlines")
    said = refusal(saved(tmp_path / "m.png", stripes))
    assert "a shore of 250500 pixel edges: at most 250000; remove its specks, crop it" in said


def test_too_many_specks_are_refused(tmp_path: Path) -> None:
    specks = np.zeros((200, 202), bool)
    specks[::2, ::2] = True
    wet = np.flatnonzero(specks)
    specks.ravel()[wet[5_001:]] = False
    assert "5001 outlines of water and islands: at most 5000; remove its specks" in refusal(
        saved(tmp_path / "m.png", specks)
    )
    specks.ravel()[wet[5_000]] = False
    assert "no water in it" in refusal(saved(tmp_path / "m.png", specks))


@pytest.mark.parametrize(
    ("values", "said"),
    [((0.0, 1.0, 2.0), "more than two different values"), ((np.nan, np.inf), "no values: a mask has two")],
)
def test_a_mask_of_other_numbers_has_two_values(tmp_path: Path, values: tuple[float, ...], said: str) -> None:
    path = saved(tmp_path / "m.tif", np.zeros((2, 2), bool))
    Image.fromarray(np.resize(np.array(values, np.float32), (20, 20))).save(path)
    assert said in refusal(path)


@pytest.mark.parametrize(("pixel", "is_refused"), [("9.0e2", False), ("1.1e3", True), ("1e30", True)])
def test_lines_far_longer_than_any_shore_are_refused(
    tmp_path: Path, pixel: str, is_refused: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The outline of 120 pixels by 120, drawn inwards, is 472 pixels long: 425 km and 519 km."""
    assert crs.MOST_LENGTH_M == 12.5 * 4e7  # round the Earth
    monkeypatch.setattr(crs, "MOST_LENGTH_M", 5e5)
    path = saved(tmp_path / "m.png", np.ones((120, 120), bool))
    path.with_suffix(".wld").write_text(f"{pixel}\n0\n0\n-{pixel}\n0\n0\n", encoding="ascii")
    path.with_suffix(".prj").write_text("EPSG:3857", encoding="ascii")
    is_long = "km long in crs WGS 84 / Pseudo-Mercator: at most 500 km"
    if is_refused:
        assert is_long in refusal(path)
    else:
        assert load_map(path).water.area > 1e9
