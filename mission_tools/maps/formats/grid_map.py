"""A grid map of the MovingAI benchmark as a chart: cells of 1 m, the lower left corner at the origin.

N. R. Sturtevant, *Benchmarks for Grid-Based Pathfinding*, IEEE Transactions on Computational
Intelligence and AI in Games 4(2), 2012. A map is a header (type octile, height, width, map) and a line of
marks a row; `.`, `G` and `S` are passable.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from companion.core.geo import LatLon, LocalFrame
from mission_tools.errors import MapError
from mission_tools.maps.chart import Chart, area_of, build_chart
from mission_tools.maps.formats.mask import SHRINK_PIXELS, outlines

NOWHERE = LatLon(0.0, 0.0)
PASSABLE = frozenset(".GS")
_HEADER = ("type", "height", "width")


def load_grid_map(path: Path, origin: LatLon | None = None) -> Chart:
    """Read a `.map` file, for scenarios, which give it an origin. Passable cells are water. Raises MapError:
    it cannot be read, is no such map, or no cell is passable; names file and line.
    """
    free = _passable(path)
    rows_down = outlines(free)
    if rows_down.is_empty:
        raise MapError(f"{path}: no passable cell with room around it")

    def rows_up(at: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack((at[:, 0], len(free) - at[:, 1]))

    water = area_of(shapely.transform(rows_down, rows_up))
    note = f"{path}: cells of 1 m; outline drawn {SHRINK_PIXELS:.2f} m into the passable ones"
    return replace(build_chart(path.stem, LocalFrame(origin or NOWHERE), water, ()), notes=(note,))


def _passable(path: Path) -> NDArray[np.bool_]:
    """Which cells are, row by row from the top."""
    try:
        lines = path.read_text(encoding="ascii").splitlines()
    except OSError as error:
        raise MapError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise MapError(f"{path}: is no text") from error
    header = dict(line.split(maxsplit=1) for line in lines[:3] if len(line.split(maxsplit=1)) == 2)
    if tuple(header) != _HEADER or header["type"] != "octile" or lines[3:4] != ["map"]:
        raise MapError(f"{path}: no MovingAI map: expected the lines type octile, height, width and map")
    try:
        height, width = int(header["height"]), int(header["width"])
    except ValueError as error:
        raise MapError(f"{path}: height and width are {header['height']} and {header['width']}") from error
    if height < 1 or width < 1:
        raise MapError(f"{path}: a map of {width} × {height} cells: expected one or more")
    rows = lines[4 : 4 + height]
    if len(rows) < height:
        raise MapError(f"{path}: {len(rows)} rows: expected {height}")
    for number, row in enumerate(rows, 5):
        if len(row) != width:
            raise MapError(f"{path} line {number}: {len(row)} cells: expected {width}")
    return np.array([[mark in PASSABLE for mark in row] for row in rows])
