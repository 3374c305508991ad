"""The grid: where its cells lie, and that none is free that should not be."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import affinity

from companion.core.geo import LatLon, LocalFrame
from mission_tools.maps import Chart, Feature, build_chart
from mission_tools.planning.grid import Grid, grid_from_rows, occupancy

pytestmark = pytest.mark.slow

FRAME = LocalFrame(LatLon(50.0, -1.2))


def basin(*obstacles: shapely.Polygon) -> Chart:
    features = [Feature(f"rock {n}", "obstacle", shape) for n, shape in enumerate(obstacles)]
    return build_chart("Basin", FRAME, shapely.box(-20, -20, 20, 20), features)


def test_a_grid_needs_a_blocked_border_and_real_cells() -> None:
    with pytest.raises(ValueError, match="border cells must be blocked"):
        Grid(np.ones((3, 3), dtype=np.bool_), 0.0, 0.0, 1.0)
    with pytest.raises(ValueError, match="cell_m must be positive"):
        Grid(np.zeros((3, 3), dtype=np.bool_), 0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="equal length"):
        grid_from_rows(["..", "."])


@given(
    east=st.floats(-15, 15),
    north=st.floats(-15, 15),
    size=st.floats(0.01, 8.0),
    turn=st.floats(0, 90),
    cell_m=st.floats(0.4, 3.0),
    clearance_m=st.floats(0.0, 5.0),
)
def test_a_cell_is_free_exactly_if_its_middle_is_far_enough_from_every_true_shore(
    east: float, north: float, size: float, turn: float, cell_m: float, clearance_m: float
) -> None:
    rock = affinity.rotate(
        shapely.box(east - size, north - 0.2 * size, east + size, north + 0.2 * size), turn
    )
    chart = basin(rock)
    grid = occupancy(chart, chart.navigable.bounds, cell_m, clearance_m)
    needed_m = math.hypot(clearance_m, cell_m / math.sqrt(2.0))
    middles = [grid.centre(cell) for cell in range(grid.rows * grid.columns)]
    at = shapely.points([(middle.east_m, middle.north_m) for middle in middles])
    to_shore_m = np.where(shapely.contains(chart.navigable, at), shapely.distance(chart.shores, at), 0.0)
    sure = np.abs(to_shore_m - needed_m) > 1e-6
    assert ((to_shore_m > needed_m) == grid.free.reshape(-1))[sure].all()


def test_a_wall_thinner_than_a_cell_still_blocks() -> None:
    chart = basin(shapely.box(-0.01, -20, 0.01, 20))
    grid = occupancy(chart, chart.navigable.bounds, 2.0, 0.0)
    eastings, _ = grid.centres()
    assert not grid.free[:, np.abs(eastings) < 1.4].any()
    assert grid.free.any()
