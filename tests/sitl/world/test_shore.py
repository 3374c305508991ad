"""Rays, room and crossings against hand-computed geometry and against shapely."""

import math
import random

import pytest
import shapely
from data_files import SHORES
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Polygon

from companion.core.geo import LatLon, LocalFrame
from mission_tools.maps.chart import Chart, Feature, build_chart
from mission_tools.maps.geojson import load_geojson
from sitl.world.shore import Shore

FRAME = LocalFrame(LatLon(50.0, -1.2))
SQUARE = shapely.box(-10.0, -10.0, 10.0, 10.0)
ROCK = Polygon([(2.0, 1.0), (3.0, 1.0), (3.0, 2.0), (2.0, 2.0)])
PLACE = st.floats(-9.9, 9.9)


def chart(water: Polygon | None, *rocks: Polygon) -> Chart:
    return build_chart("test", FRAME, water, [Feature("rock", "obstacle", rock) for rock in rocks])


SHORE = Shore(chart(SQUARE, ROCK), reach_m=4.0)


@given(east_m=PLACE, north_m=PLACE, bearing_deg=st.floats(0.0, 360.0))
def test_rays_agree_with_shapely(east_m: float, north_m: float, bearing_deg: float) -> None:
    bearings = [math.radians(bearing_deg + side) for side in (-7.5, 0.0, 7.5)]
    origin = shapely.Point(east_m, north_m)
    expected = math.inf
    for bearing in bearings:
        ray = shapely.LineString(
            [(east_m, north_m), (east_m + 4.0 * math.sin(bearing), north_m + 4.0 * math.cos(bearing))]
        )
        hit = ray.intersection(chart_water().boundary)
        if not hit.is_empty:
            expected = min(expected, origin.distance(hit))
    found = SHORE.range_m(east_m, north_m, bearings, 4.0)
    if found != expected:  # a ray that ends or grazes within rounding may be judged either way
        assert found == pytest.approx(expected, abs=1e-6) or abs(min(found, expected) - 4.0) < 1e-6


def chart_water() -> Polygon:
    return SQUARE.difference(ROCK)


@given(east_m=PLACE, north_m=PLACE)
def test_room_is_the_distance_to_the_shore_up_to_the_reach(east_m: float, north_m: float) -> None:
    distance_m = chart_water().boundary.distance(shapely.Point(east_m, north_m))
    assert SHORE.room_m(east_m, north_m) == pytest.approx(min(4.0, distance_m), abs=1e-9)


def test_open_water_has_no_shore_at_all() -> None:
    sea = Shore(chart(None), reach_m=4.0)
    assert sea.near(0.0, 0.0) == ()
    assert sea.range_m(0.0, 0.0, [0.0], 4.0) == math.inf
    assert sea.clearances_m([0.0], [0.0]) == [math.inf]


@pytest.mark.parametrize("name", ["pond_citra_fl", "harbour_san_juan_pr", "lake_squam_nh"])
def test_real_shorelines_give_the_room_and_the_echoes_that_shapely_does(name: str) -> None:
    waters = load_geojson(SHORES / f"{name}.geojson")
    shore = Shore(waters, reach_m=4.0)
    edge = waters.water.boundary
    place = random.Random(name)
    for _ in range(50):
        at = edge.interpolate(place.random(), normalized=True)
        east_m, north_m = at.x + place.uniform(-3.0, 3.0), at.y + place.uniform(-3.0, 3.0)
        bearing = place.uniform(0.0, math.tau)
        end = (east_m + 4.0 * math.sin(bearing), north_m + 4.0 * math.cos(bearing))
        hit = edge.intersection(shapely.LineString([(east_m, north_m), end]))
        here = shapely.Point(east_m, north_m)
        assert shore.room_m(east_m, north_m) == pytest.approx(min(4.0, edge.distance(here)), abs=1e-6)
        expected = math.inf if hit.is_empty else here.distance(hit)
        assert shore.range_m(east_m, north_m, [bearing], 4.0) == pytest.approx(expected, abs=1e-6)
