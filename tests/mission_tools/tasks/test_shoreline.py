"""Following a shore: the distance held, the side, the stretch."""

import numpy as np
import pytest
import shapely
from task_waters import FRAME, POND, basin, real_lake, route_line

from companion.core.geo import Point
from mission_tools.errors import NoRoute, UsageError
from mission_tools.maps import Chart, build_chart, load_geojson
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.shoreline import ShoreSettings, follow_shore
from mission_tools.tasks.task_route import TaskRoute

pytestmark = pytest.mark.slow

ISLAND = shapely.box(80.0, 40.0, 120.0, 60.0)
AT_ISLAND = Point(38.0, 100.0)


def gaps_m(chart: Chart, found: TaskRoute) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Distances to the nearest shore, every half metre along the shore legs."""
    line = route_line(next(leg.points for leg in found.legs if leg.kind == "shore"))
    return np.asarray(chart.shores.distance(line.interpolate(np.arange(0.0, line.length, 0.5))))


@pytest.mark.parametrize("side", ["port", "starboard"])
@pytest.mark.parametrize(("near", "is_outer"), [(AT_ISLAND, False), (Point(1.0, 50.0), True)])
def test_the_shore_lies_on_the_side_asked_for(side: str, near: Point, is_outer: bool) -> None:
    found = follow_shore(basin(ISLAND), None, ShoreSettings(near, 10.0, shore_to=side))  # type: ignore[arg-type]
    ring = shapely.LinearRing(route_line(found.points).coords)
    assert ring.is_closed
    # Counter-clockwise, an island lies to port and an outer shore to starboard.
    assert shapely.is_ccw(ring) == ((side == "starboard") == is_outer)


def test_the_distance_is_held_within_the_error() -> None:
    chart = load_geojson(POND, FRAME.origin)
    found = follow_shore(chart, None, ShoreSettings(Point(0.0, -150.0), 8.0, error_m=0.5))
    gap_m = gaps_m(chart, found)
    assert gap_m.min() >= 7.5
    assert gap_m.max() <= 8.5 + 0.1  # the polygon of the distance itself lies up to a hundredth outside
    assert len(found.points) < 150


def test_a_real_shore_is_never_nearer_than_the_clearance() -> None:
    chart = real_lake("pond_two_islands_nh")
    outer = max(shapely.get_parts(chart.navigable), key=lambda part: part.area).exterior
    near = Point(outer.coords[0][1], outer.coords[0][0])
    found = follow_shore(chart, None, ShoreSettings(near, 5.0, PlanSettings(clearance_m=4.8)))
    assert found.min_clearance_m(chart) >= 4.8
    assert gaps_m(chart, found).max() <= 5.6


def test_the_way_there_is_a_transit_and_the_round_begins_near_the_boat() -> None:
    start = Point(50.0, 10.0)
    found = follow_shore(basin(ISLAND), start, ShoreSettings(AT_ISLAND, 10.0))
    assert [leg.kind for leg in found.legs] == ["transit", "shore"]
    assert found.legs[0].points[0] == start
    assert found.legs[0].points[1] == pytest.approx(Point(50.0, 70.0), abs=0.2)
    assert found.legs[1].points[0] == found.legs[1].points[-1]


@pytest.mark.parametrize("side", ["port", "starboard"])
def test_a_stretch_runs_from_one_place_to_the_other(side: str) -> None:
    """From the island's south-west corner to its north-west corner, 10 m off, either way round."""
    settings = ShoreSettings(
        AT_ISLAND,
        10.0,
        shore_to=side,  # type: ignore[arg-type]
        first=Point(30.0, 80.0),
        last=Point(70.0, 80.0),
        error_m=0.1,
    )
    found = follow_shore(basin(ISLAND), None, settings)
    first, last = found.points[0], found.points[-1]
    assert (first.east_m, last.east_m) == pytest.approx((80.0, 80.0), abs=0.2)
    assert (first.north_m, last.north_m) == pytest.approx((30.0, 70.0), abs=0.2)
    round_the_west_m = 20.0 + 10.0 * np.pi
    whole_m = 120.0 + 20.0 * np.pi
    expected_m = whole_m - round_the_west_m if side == "port" else round_the_west_m
    assert found.length_m == pytest.approx(expected_m, rel=0.01)


def test_what_makes_no_sense_is_refused() -> None:
    with pytest.raises(UsageError, match="expected the clearance of 4 m or more"):
        ShoreSettings(AT_ISLAND, 3.0)
    with pytest.raises(UsageError, match="needs both its ends"):
        ShoreSettings(AT_ISLAND, 10.0, first=AT_ISLAND)
    with pytest.raises(NoRoute, match="60 m from every shore"):
        follow_shore(basin(ISLAND), None, ShoreSettings(AT_ISLAND, 60.0))


def test_open_water_has_no_shore_to_follow() -> None:
    with pytest.raises(NoRoute, match="no shore"):
        follow_shore(build_chart("Sea", FRAME, None, []), None, ShoreSettings(AT_ISLAND, 10.0))
