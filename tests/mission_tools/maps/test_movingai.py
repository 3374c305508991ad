"""MovingAI maps and scenarios: what they say, what is wrong in a bad one, and their published lengths."""

from pathlib import Path

import pytest
from data_files import GRIDS

from companion.planning import jump_points
from companion.planning.grid import STRAIGHT, GridMap, shortest_path
from mission_tools.errors import MapError
from mission_tools.maps.movingai import GridQuery, read_grid_map, read_grid_queries

PUBLISHED = 6e-6  # six digits are published

MAP = """type octile
height 2
width 4
map
.G@T
SOW.
"""


@pytest.fixture(scope="module")
def arena() -> tuple[GridMap, list[GridQuery]]:
    return read_grid_map(GRIDS / "arena2.map"), read_grid_queries(GRIDS / "arena2.map.scen")


def test_every_shortest_path_has_the_published_length(arena: tuple[GridMap, list[GridQuery]]) -> None:
    grid, queries = arena
    assert len(queries) > 900
    for query in queries[:: 1 if grid.searcher.__class__ is not jump_points.Searcher else 40]:
        assert shortest_path(grid, query.start, query.goal).length == pytest.approx(
            query.length, rel=PUBLISHED
        ), query


def test_the_twin_finds_the_published_lengths_too(arena: tuple[GridMap, list[GridQuery]]) -> None:
    grid, queries = arena
    twin = jump_points.Searcher(grid.free, grid.width, grid.height)
    for query in queries[:: len(queries) // 15]:
        corners, cost, _ = twin.shortest(query.start, query.goal)
        assert corners is not None
        assert cost / STRAIGHT == pytest.approx(query.length, rel=PUBLISHED), query


def written(folder: Path, text: str, name: str = "pond.map") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_a_map_is_read_row_by_row_from_the_top(tmp_path: Path) -> None:
    grid = read_grid_map(written(tmp_path, MAP))
    assert (grid.width, grid.height) == (4, 2)
    assert grid.free == bytes((1, 1, 0, 0, 1, 0, 0, 1))


def test_a_query_counts_columns_then_rows(tmp_path: Path) -> None:
    path = written(tmp_path, "version 1\n0\tpond.map\t4\t2\t1\t0\t0\t1\t2\n", "pond.map.scen")
    assert read_grid_queries(path) == [GridQuery(1, 4, 2.0)]


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("type tile\nheight 2\nwidth 4\nmap\n....\n....\n", "no MovingAI map"),
        ("height 2\nwidth 4\nmap\n....\n....\n", "no MovingAI map"),
        ("", "no MovingAI map"),
        (MAP.replace("height 2", "height two"), "height and width are two and 4"),
        (MAP.replace("height 2", "height 3"), "2 rows: expected 3"),
        (MAP.replace("SOW.", "SOW"), "line 6: 3 cells: expected 4"),
        (MAP.replace("height 2", "height 0"), "grid map of 4 × 0 cells"),
        (MAP.replace("T", "±"), "is no text"),
    ],
)
def test_a_bad_map_is_named_with_its_line(tmp_path: Path, text: str, complaint: str) -> None:
    with pytest.raises(MapError, match=rf"pond\.map.*{complaint}"):
        read_grid_map(written(tmp_path, text))


def test_bad_scenarios_are_named_with_their_line(tmp_path: Path) -> None:
    with pytest.raises(MapError, match=r"nowhere\.map: cannot be read"):
        read_grid_map(tmp_path / "nowhere.map")
    with pytest.raises(MapError, match="expected version"):
        read_grid_queries(written(tmp_path, MAP))
    with pytest.raises(MapError, match="line 2: no query: expected nine fields"):
        read_grid_queries(written(tmp_path, "version 1\n0\tpond.map\t4\t2\t1\t0\n"))
