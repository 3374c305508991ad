"""The grid of the water against the fence's own margin, cell by cell."""

import math
from itertools import pairwise

import pytest
from test_distance_field import L_WATER
from test_fence_lines import globe, laid, square

from companion.core.geo import Point, distance_m
from companion.geofence.costmap import Costmap
from companion.geofence.distance_field import DistanceField
from companion.geofence.fence import Fence, FenceCircle, FencePolygon

ISLAND = FenceCircle(globe([(0.0, 30.0)])[0], 4.0, is_inclusion=False)


def mapped(fence: Fence, clearance_m: float, *within: Point, looks: int = 7) -> Costmap:
    grid = Costmap(fence, within, clearance_m)
    for _ in range(100_000):
        if grid.is_complete:
            return grid
        grid.advance(looks)
    raise AssertionError("the grid is never complete")


@pytest.mark.parametrize("clearance_m", [2.0, 4.5])
@pytest.mark.parametrize("looks", [1, 100_000])
def test_a_cell_is_free_where_its_centre_has_the_clearance(clearance_m: float, looks: int) -> None:
    fence = laid(L_WATER, ISLAND)
    grid = mapped(fence, clearance_m, looks=looks)
    for cell in range(len(grid.free)):
        row, column = divmod(cell, grid.columns)
        centre = Point(grid.south_m + (row + 0.5) * grid.cell_m, grid.west_m + (column + 0.5) * grid.cell_m)
        assert grid.centre(cell) == pytest.approx(centre)
        spare_m = fence.margin_m(centre) - grid.clearance_m
        if abs(spare_m) > 1e-6:
            assert grid.free[cell] == (spare_m > 0.0)


def test_the_grid_covers_the_box_of_the_water_with_a_border_of_one_cell() -> None:
    grid = Costmap(laid(L_WATER), [], 4.5)
    assert grid.cell_m == pytest.approx(1.5)
    assert grid.clearance_m == 4.5
    assert (grid.south_m, grid.west_m) == pytest.approx((-16.5, -16.5), abs=0.01)
    for size in (grid.rows, grid.columns):
        assert size in (62, 63), "90 m by 1.5 m, and two; the globe is not quite flat"
    assert len(grid.free) == grid.rows * grid.columns


def test_the_water_of_several_areas_is_where_all_of_them_are() -> None:
    grid = Costmap(laid(square(30.0), square(30.0, north_m=40.0)), [], 3.0)
    assert (grid.south_m + grid.cell_m, grid.west_m + grid.cell_m) == pytest.approx((10.0, -30.0), abs=0.01)
    assert grid.rows in (22, 23)
    assert grid.columns in (62, 63)


def test_open_water_is_mapped_round_what_has_to_be_in_it() -> None:
    # From 0 to 110 m north and 0 to 60 m east, and 30 m on every side: 170 by 120 m
    island = FenceCircle(globe([(100.0, 50.0)])[0], 10.0, is_inclusion=False)
    grid = Costmap(laid(island), [Point(0.0, 0.0)], 3.0)
    assert grid.cell_m == pytest.approx(math.sqrt(170.0 * 120.0 / 16_000.0), rel=1e-4)
    assert grid.south_m + grid.cell_m == pytest.approx(-30.0, abs=0.01)
    assert grid.west_m + grid.cell_m == pytest.approx(-30.0, abs=0.01)
    assert grid.rows == pytest.approx(170.0 / grid.cell_m + 2.0, abs=1.0)
    assert grid.columns == pytest.approx(120.0 / grid.cell_m + 2.0, abs=1.0)
    far = Costmap(laid(island), [Point(-200.0, 300.0)], 3.0)
    assert far.south_m + far.cell_m == pytest.approx(-230.0, abs=0.01)
    assert far.west_m + far.columns * far.cell_m > 330.0


@pytest.mark.parametrize(
    ("half_m", "clearance_m", "cell_m", "kept_m"),
    [
        (50.0, 6.0, 2.0, 6.0),  # a third of the clearance
        (50.0, 0.3, 100.0 / math.sqrt(16_000.0), 75.0 / math.sqrt(16_000.0)),  # cells of water are limited
        (2.0, 0.03, 0.05, 0.0375),  # the least cell
    ],
)
def test_the_cell_is_as_fine_as_clearance_and_memory_allow(
    half_m: float, clearance_m: float, cell_m: float, kept_m: float
) -> None:
    grid = Costmap(laid(square(half_m)), [], clearance_m)
    assert grid.cell_m == pytest.approx(cell_m, rel=1e-3)
    assert grid.clearance_m == pytest.approx(kept_m, rel=1e-3)


def test_a_thin_diagonal_water_does_not_need_a_grid_beyond_bounds() -> None:
    thin = FencePolygon(globe([(0.0, 0.0), (5000.0, 4999.0), (5000.0, 5001.0)]), is_inclusion=True)
    grid = Costmap(laid(thin), [], 0.1)
    assert len(grid.free) == pytest.approx(400_000, rel=0.02)


def test_the_cell_of_a_point_is_the_nearest_inside_the_border() -> None:
    grid = mapped(laid(L_WATER), 4.5)
    at = grid.cell(Point(10.2, 20.7))
    centre = grid.centre(at)
    assert abs(centre.north_m - 10.2) <= 0.75
    assert abs(centre.east_m - 20.7) <= 0.75
    for point, row, column in (
        (Point(-900.0, -900.0), 1, 1),
        (Point(900.0, 900.0), grid.rows - 2, grid.columns - 2),
        (Point(900.0, -900.0), grid.rows - 2, 1),
    ):
        assert divmod(grid.cell(point), grid.columns) == (row, column)


@pytest.mark.parametrize("point", [Point(0.0, 0.0), Point(70.0, 70.0), Point(12.0, -12.0)])
def test_around_a_point_are_the_free_cells_of_a_square(point: Point) -> None:
    grid = mapped(laid(L_WATER), 4.5)
    row, column = divmod(grid.cell(point), grid.columns)
    expected = {
        cell
        for cell in range(len(grid.free))
        if grid.free[cell] and max(abs(cell // grid.columns - row), abs(cell % grid.columns - column)) <= 6
    }
    assert set(grid.around(point, 6)) == expected


def field_of(fence: Fence, *goals: Point, clearance_m: float = 1.5) -> DistanceField:
    field = DistanceField(fence, goals, Costmap(fence, goals, clearance_m))
    while not field.is_complete:
        field.advance()
    return field


@pytest.mark.parametrize("axis", [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)])
def test_along_a_narrow_water_the_distance_is_its_length_whichever_way_it_goes(
    axis: tuple[float, float],
) -> None:
    corners = [(-2.0, -2.0), (-2.0, 2.0), (62.0, 2.0), (62.0, -2.0)]
    turned = [(n * axis[0] - e * axis[1], n * axis[1] + e * axis[0]) for n, e in corners]
    field = field_of(laid(FencePolygon(globe(turned), is_inclusion=True)), Point(0.0, 0.0))
    end = Point(60.0 * axis[0], 60.0 * axis[1])
    assert field.distance_m(end) == pytest.approx(60.0, abs=1.0)
    way = field.way(end)
    assert way[-1] == Point(0.0, 0.0)
    assert len(way) > 60.0 / (1.5 * field.grid.cell_m)
    steps = [distance_m(one, other) for one, other in pairwise(way)]
    assert max(steps) <= 1.5 * field.grid.cell_m


def test_near_a_goal_the_distance_is_exact_to_the_centre_and_on_to_the_point() -> None:
    field = field_of(laid(square(50.0)), Point(3.0, 4.0), clearance_m=3.0)
    for point in (Point(6.3, 8.2), Point(0.1, 1.9), Point(3.4, 9.6)):
        centre = field.grid.centre(field.grid.cell(point))
        expected = distance_m(centre, Point(3.0, 4.0)) + distance_m(centre, point)
        assert field.distance_m(point) == pytest.approx(expected)


def test_of_two_goals_the_nearer_counts() -> None:
    field = field_of(laid(square(50.0)), Point(-40.0, 0.0), Point(40.0, 0.0), clearance_m=3.0)
    assert field.distance_m(Point(25.0, 0.0)) == pytest.approx(15.0, abs=1.5)
    assert field.distance_m(Point(-15.0, 0.0)) == pytest.approx(25.0, abs=1.5)
    assert field.way(Point(-15.0, 0.0))[-1] == Point(-40.0, 0.0)


def test_a_field_is_not_complete_before_it_has_begun() -> None:
    field = DistanceField(laid(square(50.0)), [Point(0.0, 0.0)], mapped(laid(square(50.0)), 3.0))
    assert not field.is_complete
    assert math.isinf(field.distance_m(Point(10.0, 0.0)))
    assert field.way(Point(10.0, 0.0)) == []


def test_around_a_point_at_the_edge_of_the_grid_are_no_cells_of_another_row() -> None:
    grid = mapped(laid(FenceCircle(globe([(0.0, 0.0)])[0], 10.0, is_inclusion=False)), 3.0)
    north, east = grid.rows - 2, grid.columns - 2  # the last row and column inside the border
    for point, rows, columns in (
        (Point(900.0, 900.0), (north - 4, north), (east - 4, east)),
        (Point(-900.0, 900.0), (1, 5), (east - 4, east)),
        (Point(-900.0, -900.0), (1, 5), (1, 5)),
        (Point(900.0, -900.0), (north - 4, north), (1, 5)),
    ):
        found = [divmod(cell, grid.columns) for cell in grid.around(point, 4)]
        assert found == [
            (row, column)
            for row in range(rows[0], rows[1] + 1)
            for column in range(columns[0], columns[1] + 1)
        ]


@pytest.mark.parametrize("order", [1, -1])
def test_the_common_water_of_two_areas_is_bounded_by_the_nearest_line_on_every_side(order: int) -> None:
    one = [(-30.0, -30.0), (-30.0, 30.0), (30.0, 30.0), (30.0, -30.0)]
    other = [(-10.0, 0.0), (-10.0, 60.0), (50.0, 60.0), (50.0, 0.0)]
    areas = [FencePolygon(globe(corners), is_inclusion=True) for corners in (one, other)][::order]
    grid = Costmap(laid(*areas), [], 3.0)
    assert grid.cell_m == pytest.approx(1.0)
    assert (grid.south_m + grid.cell_m, grid.west_m + grid.cell_m) == pytest.approx((-10.0, 0.0), abs=0.01)
    assert grid.rows in (42, 43), "40 m and two"
    assert grid.columns in (32, 33), "30 m and two"


@pytest.mark.parametrize("north_m", [200.0, -200.0])
def test_areas_without_common_water_leave_no_free_cell(north_m: float) -> None:
    grid = mapped(laid(square(30.0), square(30.0, north_m=north_m)), 3.0)
    assert grid.rows == 2
    assert not any(grid.free)


def test_the_cells_are_as_many_as_the_water_of_a_circle_needs() -> None:
    circle = FenceCircle(globe([(0.0, 0.0)])[0], 100.0, is_inclusion=True)
    grid = Costmap(laid(circle), [], 0.3)
    assert grid.cell_m == pytest.approx(math.sqrt(math.pi * 1e4 / 16_000.0), rel=1e-3)
