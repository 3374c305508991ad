"""A grid map of the MovingAI benchmark as a chart: cells of 1 m, the lower left corner at the origin."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from companion.core.geo import LatLon, LocalFrame
from mission_tools.errors import MapError
from mission_tools.maps.chart import Chart, area_of, build_chart
from mission_tools.maps.formats.mask import SHRINK_PIXELS, outlines
from mission_tools.maps.movingai import read_grid_map

NOWHERE = LatLon(0.0, 0.0)


def load_grid_map(path: Path, origin: LatLon | None = None) -> Chart:
    """Read a `.map` file, for scenarios, which give it an origin. Passable cells are water.

    Raises:
        MapError: it cannot be read, or no cell is passable.
    """
    grid = read_grid_map(path)
    free = np.frombuffer(grid.free, np.uint8).reshape(grid.height, grid.width) > 0
    rows_down = outlines(free)
    if rows_down.is_empty:
        raise MapError(f"{path}: no passable cell with room around it")

    def rows_up(at: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack((at[:, 0], grid.height - at[:, 1]))

    water = area_of(shapely.transform(rows_down, rows_up))
    note = f"{path}: cells of 1 m; outline drawn {SHRINK_PIXELS:.2f} m into the passable ones"
    return replace(build_chart(path.stem, LocalFrame(origin or NOWHERE), water, ()), notes=(note,))
