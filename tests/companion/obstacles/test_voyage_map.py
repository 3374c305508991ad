"""The map of the voyage: what is kept by place, what is refuted, and its outlines."""

import math

from companion.core.geo import Point, distance_m
from companion.obstacles.perception.occupancy import Beam, Occupancy
from companion.obstacles.perception.voyage_map import MAX_CELLS, VoyageMap

HERE = Point(0.0, 0.0)
REACH_M = 18.0
WIDTH_RAD = math.radians(15.0)


class Water:
    """A local grid and the map that is kept of it, a second apart."""

    def __init__(self) -> None:
        self.grid, self.map = Occupancy(0.2), VoyageMap()
        self.now_s = 0.0

    def ping(self, range_m: float, bearing_rad: float = 0.0, at: Point = HERE) -> None:
        self.now_s += 0.05
        self.grid.add(Beam(self.now_s, at, bearing_rad, WIDTH_RAD, range_m, 4.0))

    def update(self, *movers: Point, here: Point = HERE) -> None:
        self.now_s += 0.5
        self.map.update(self.grid, 1.0, movers, here, REACH_M, self.now_s)

    def see(self, at: Point) -> None:
        """Something, from two metres south of it."""
        for _ in range(3):
            self.ping(2.0, at=Point(at.north_m - 2.0, at.east_m))
        self.update(here=at)


def seen_at(at: Point) -> VoyageMap:
    water = Water()
    water.see(at)
    return water.map


def test_what_was_seen_three_times_is_kept_when_the_local_grid_has_forgotten_it() -> None:
    water = Water()
    water.see(Point(3.0, 0.0))
    water.now_s += 3600.0
    water.grid.forget(Point(500.0, 0.0), REACH_M, water.now_s)
    water.update(here=Point(500.0, 0.0))
    assert len(water.grid) == 0
    assert water.map.is_near(Point(3.0, 0.0), 0.5)
    assert not water.map.is_near(Point(3.0, 2.0), 0.5)


def test_two_echoes_are_not_kept() -> None:
    water = Water()
    for _ in range(2):
        water.ping(3.0)
    water.update()
    assert water.map.stretches() == []
    assert water.map.version == 0


def test_the_local_grid_is_given_back_what_is_near_the_boat_and_only_that() -> None:
    water = Water()
    water.see(Point(3.5, 0.5))
    water.grid.clear()
    water.update(here=Point(3.5 + REACH_M + 1.0, 0.5))
    assert len(water.grid) == 0
    water.update(here=Point(3.5 + REACH_M - 1.0, 0.5))
    (restored,) = water.grid.obstacles()
    assert distance_m(restored, Point(3.5, 0.5)) < 0.3


def test_a_place_that_was_seen_through_is_free_again() -> None:
    water = Water()
    water.see(Point(3.0, 0.0))
    version = water.map.version
    water.grid.clear()
    water.update()
    for _ in range(8):
        water.ping(math.inf)
    water.update()
    assert not water.map.is_near(Point(3.0, 0.0), 0.5)
    assert water.map.version > version
    assert water.map.stretches() == []


def test_what_the_boat_looks_through_is_not_given_back_meanwhile() -> None:
    water = Water()
    water.see(Point(3.0, 0.0))
    for _ in range(8):  # one look a second
        water.ping(math.inf)
        water.update()
    assert not water.map.is_near(Point(3.0, 0.0), 0.5)


def test_what_moves_leaves_nothing_behind() -> None:
    water = Water()
    for _ in range(3):
        water.ping(3.0)
    water.update(Point(4.5, 0.0))
    assert not water.map.is_near(Point(3.0, 0.0), 1.0)
    for _ in range(2):
        water.ping(3.0)
    water.update(Point(6.0, 0.0))
    assert water.map.is_near(Point(3.0, 0.0), 1.0)


def test_the_nearest_of_what_was_seen_is_found_within_a_distance() -> None:
    water = Water()
    for at in (Point(3.5, 0.5), Point(3.5, 4.5)):
        water.see(at)
    nearest = water.map.nearest(Point(3.5, 3.0), 3.0)
    assert nearest is not None
    assert distance_m(nearest, Point(3.5, 4.5)) < 0.3
    assert water.map.nearest(Point(3.5, 3.0), 1.0) is None
    assert water.map.nearest(Point(-30.0, 3.0), 3.0) is None


def test_cells_of_half_a_metre_are_searched_as_far() -> None:
    water = Water()
    water.map.update(water.grid, 0.5, (), HERE, REACH_M, water.now_s)
    for _ in range(3):
        water.ping(3.0)
    water.map.update(water.grid, 0.5, (), HERE, REACH_M, water.now_s)
    assert water.map.is_near(Point(0.5, 0.0), 3.0)


def bars(seen: VoyageMap, start: Point, end: Point) -> bool:
    return seen.bars(start, end, 1.0, (start, end))


def test_a_way_is_barred_by_what_it_passes_too_near() -> None:
    seen = seen_at(Point(3.5, 0.5))
    assert bars(seen, Point(3.5, -5.0), Point(3.5, 5.0))
    assert bars(seen, Point(4.3, -5.0), Point(4.3, 5.0))
    assert not bars(seen, Point(4.8, -5.0), Point(4.8, 5.0))
    assert not bars(seen, Point(3.5, 2.5), Point(3.5, 9.0)), "it ends before"


def test_a_way_from_beside_something_may_lead_away_but_not_nearer() -> None:
    seen = seen_at(Point(3.5, 0.5))
    assert not bars(seen, Point(4.0, 0.5), Point(9.0, 0.5))
    assert bars(seen, Point(4.0, 0.5), Point(-9.0, 0.5))
    assert seen.bars(Point(4.0, 0.5), Point(9.0, 0.5), 1.0, ()), "a corner of a way has room"


def test_a_wall_is_outlined_by_few_stretches_without_a_gap() -> None:
    water, wall = Water(), [Point(0.5 * east, float(east)) for east in range(40)]
    for at in wall:
        water.see(at)
    stretches = water.map.stretches()
    assert len(stretches) < 12
    for at in wall:
        start, end = Point(at.north_m - 6.0, at.east_m), Point(at.north_m + 6.0, at.east_m)
        nearest_m = min(distance_to(one, start, end) for one in stretches)
        assert nearest_m < 0.2, "every way across meets one"


def distance_to(stretch: tuple[Point, Point], start: Point, end: Point) -> float:
    """Between two straight lines, by a hundred places of each."""
    return min(
        distance_m(stretch[0].towards(stretch[1], a / 100.0), start.towards(end, b / 100.0))
        for a in range(101)
        for b in range(101)
    )


def test_another_voyage_and_another_margin_begin_with_an_empty_map() -> None:
    water = Water()
    water.see(Point(3.0, 0.0))
    version = water.map.version
    water.map.clear()
    assert water.map.version > version
    assert water.map.stretches() == []
    water.see(Point(3.0, 0.0))
    water.now_s += 1.0
    water.map.update(water.grid, 2.0, (), Point(500.0, 0.0), REACH_M, water.now_s)
    assert water.map.stretches() == []


def test_of_too_much_the_oldest_is_forgotten() -> None:
    seen = VoyageMap()
    for number in range(MAX_CELLS + 1):
        seen._add((number, 0), Point(number + 0.5, 0.5))
    assert len(seen._seen) == MAX_CELLS
    assert not seen.is_near(Point(0.5, 0.5), 0.4)
    assert seen.is_near(Point(MAX_CELLS + 0.5, 0.5), 0.4)
