"""Grid maps of the MovingAI benchmark: what is wrong in a bad one."""

from pathlib import Path

import pytest

from mission_tools.errors import MapError
from mission_tools.maps.formats.grid_map import load_grid_map

MAP = """type octile
height 2
width 4
map
.G@T
SOW.
"""


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("type tile\nheight 2\nwidth 4\nmap\n....\n....\n", "no MovingAI map"),
        ("", "no MovingAI map"),
        (MAP.replace("height 2", "height two"), "height and width are two and 4"),
        (MAP.replace("height 2", "height 3"), "2 rows: expected 3"),
        (MAP.replace("SOW.", "SOW"), "line 6: 3 cells: expected 4"),
        (MAP.replace("height 2", "height 0"), "a map of 4 × 0 cells"),
        (MAP.replace("T", "±"), "is no text"),
        ("type octile\nheight 1\nwidth 4\nmap\n....\n", "no passable cell with room around it"),
        (None, "cannot be read"),
    ],
)
def test_a_bad_map_is_named_with_its_line(tmp_path: Path, text: str | None, complaint: str) -> None:
    path = tmp_path / "pond.map"
    if text is not None:
        path.write_text(text, encoding="utf-8")
    with pytest.raises(MapError, match=rf"pond\.map.*{complaint}"):
        load_grid_map(path)
