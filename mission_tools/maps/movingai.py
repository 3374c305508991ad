"""Grid maps and scenarios of the MovingAI benchmark (N. R. Sturtevant, *Benchmarks for Grid-Based
Pathfinding*, IEEE Transactions on Computational Intelligence and AI in Games 4(2), 2012).

A map is a header (type octile, height, width, map) and a line of marks a row; `.`, `G` and `S` are passable.
A scenario file has a line a query: bucket, map, width, height, start and goal as column and row from the top
left, and the shortest octile length without cut corners.
"""

from pathlib import Path
from typing import NamedTuple

from companion.planning.grid import GridInputError, GridMap
from mission_tools.errors import MapError

PASSABLE = frozenset(".GS")
_HEADER = ("type", "height", "width")


class GridQuery(NamedTuple):
    """A line of a scenario file. start, goal: cell numbers. length: the shortest, with six digits."""

    start: int
    goal: int
    length: float


def read_grid_map(path: Path) -> GridMap:
    """Read a `.map` file.

    Raises:
        MapError: it cannot be read, is no such map, or its rows are not of its size; names file and line.
    """
    lines = _lines(path)
    header = dict(line.split(maxsplit=1) for line in lines[:3] if len(line.split(maxsplit=1)) == 2)
    if tuple(header) != _HEADER or header["type"] != "octile" or lines[3:4] != ["map"]:
        raise MapError(f"{path}: no MovingAI map: expected the lines type octile, height, width and map")
    try:
        height, width = int(header["height"]), int(header["width"])
    except ValueError as error:
        raise MapError(f"{path}: height and width are {header['height']} and {header['width']}") from error
    rows = lines[4 : 4 + height]
    if len(rows) < height:
        raise MapError(f"{path}: {len(rows)} rows: expected {height}")
    for number, row in enumerate(rows, 5):
        if len(row) != width:
            raise MapError(f"{path} line {number}: {len(row)} cells: expected {width}")
    try:
        return GridMap(bytes(mark in PASSABLE for row in rows for mark in row), width, height)
    except GridInputError as error:
        raise MapError(f"{path}: {error}") from error


def read_grid_queries(path: Path) -> list[GridQuery]:
    """Read a `.scen` file.

    Raises:
        MapError: it cannot be read or a line is no query; names file and line.
    """
    lines = _lines(path)
    if not lines or not lines[0].startswith("version"):
        raise MapError(f"{path}: no MovingAI scenarios: expected version in the first line")
    queries = []
    for number, line in enumerate(lines[1:], 2):
        if not line:
            continue
        try:
            *_, width, _, start_x, start_y, goal_x, goal_y, length = line.split()
            columns = int(width)
            start, goal = int(start_y) * columns + int(start_x), int(goal_y) * columns + int(goal_x)
            queries.append(GridQuery(start, goal, float(length)))
        except ValueError as error:
            raise MapError(f"{path} line {number}: no query: expected nine fields") from error
    return queries


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="ascii").splitlines()
    except OSError as error:
        raise MapError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise MapError(f"{path}: is no text") from error
