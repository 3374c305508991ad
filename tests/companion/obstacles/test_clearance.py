"""Distances to obstacles and the fence, looked up in the grid."""

import math
import random

import pytest
from avoidance_rig import Lines

from companion.core.geo import Point
from companion.obstacles.planning.clearance import FENCE, LEVELS, SOLID, ClearanceField

CELL_M = 0.2
ORIGIN = Point(0.0, 0.0)
FAR_M = LEVELS * CELL_M


def field_of(*solid: Point, suspects: tuple[Point, ...] = (), at: Point = ORIGIN) -> ClearanceField:
    field = ClearanceField(at, CELL_M, 9.0)
    field.fill(list(solid), [*solid, *suspects], 0.4)
    return field


@pytest.mark.parametrize("seed", range(2))
def test_the_distance_is_that_to_the_nearest_obstacle(seed: int) -> None:
    """Within a cell and the 8 % of the octagon, wherever the grid lies."""
    chance = random.Random(f"clearance {seed}")
    at = Point(chance.uniform(-50.0, 50.0), chance.uniform(-50.0, 50.0))
    rocks = [
        Point(at.north_m + chance.uniform(-8.0, 8.0), at.east_m + chance.uniform(-8.0, 8.0)) for _ in range(5)
    ]
    field = field_of(*rocks, at=at)
    for _ in range(300):
        place = Point(at.north_m + chance.uniform(-8.0, 8.0), at.east_m + chance.uniform(-8.0, 8.0))
        true_m = min(math.dist(place, rock) for rock in rocks)
        found_m = field.distance_m(*place)
        if found_m < FAR_M:
            assert found_m == pytest.approx(true_m, abs=0.25 + 0.1 * true_m)
        else:
            assert true_m > FAR_M - 0.4


def test_only_certain_obstacles_are_marked_as_touching() -> None:
    field = field_of(Point(3.1, 0.1), suspects=(Point(-2.9, 0.1),))
    assert field.at(3.1, 0.1) & SOLID
    assert field.at(2.7, 0.1) & SOLID
    assert not field.at(2.5, 0.1) & SOLID
    assert field.distance_m(-2.9, 0.1) == 0.0
    assert not field.at(-2.9, 0.1) & SOLID


@pytest.mark.parametrize("margin_m", [0.0, 1.0, 2.0])
def test_the_fence_is_marked_up_to_its_margin(margin_m: float) -> None:
    field = ClearanceField(Point(0.0, 0.0), CELL_M, 9.0)
    field.fence(Lines(-4.0, 5.0), margin_m)
    field.fill([], [], 0.4)
    for east_m in (-8.1, -4.3, 4.9 - margin_m + 0.5, 7.9):
        assert field.at(0.1, east_m) & FENCE, east_m
    for east_m in (-4.0 + margin_m + 0.3, 0.1, 5.0 - margin_m - 0.3):
        assert not field.at(0.1, east_m) & FENCE, east_m


def test_fence_and_obstacle_share_a_cell() -> None:
    field = ClearanceField(Point(0.0, 0.0), CELL_M, 9.0)
    field.fence(Lines(-4.0, 2.0), 1.0)
    field.fill([Point(0.1, 3.1)], [Point(0.1, 3.1)], 0.4)
    assert field.at(0.1, 3.1) & FENCE
    assert field.at(0.1, 3.1) & SOLID
    assert field.distance_m(0.1, 3.1) == 0.0
