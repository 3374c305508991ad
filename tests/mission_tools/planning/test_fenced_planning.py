"""Planning inside a fence: no route leaves an inclusion or enters an exclusion."""

import math

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.errors import MapError, NoRouteError, StartBlocked
from mission_tools.maps import Chart, build_chart
from mission_tools.maps.fenced import fence_area, fenced
from mission_tools.mission.mission import Fence, FenceCircle, FencePolygon
from mission_tools.planning.planner import PlanSettings, plan

pytestmark = pytest.mark.slow

FRAME = LocalFrame(LatLon(50.0, -1.2))
CLEARANCE_M = 3.0
TOUCH_M = 0.01
POND = build_chart("Pond", FRAME, shapely.box(-100.0, -100.0, 100.0, 100.0), ())
SEA = build_chart("Sea", FRAME, None, ())


def place(east_m: float, north_m: float) -> LatLon:
    return FRAME.to_global(Point(north_m, east_m))


def box(west: float, south: float, east: float, north: float, *, inclusion: bool = True) -> FencePolygon:
    corners = ((west, south), (east, south), (east, north), (west, north))
    return FencePolygon(tuple(place(*corner) for corner in corners), inclusion)


def disc(east: float, north: float, radius_m: float, *, inclusion: bool = False) -> FenceCircle:
    return FenceCircle(place(east, north), radius_m, inclusion)


def routed(chart: Chart, start: tuple[float, float], goal: tuple[float, float]) -> shapely.LineString:
    ends = [Point(north_m, east_m) for east_m, north_m in (start, goal)]
    found = plan(chart, ends[0], ends[1], PlanSettings(CLEARANCE_M, cell_m=2.0))
    return shapely.LineString([(point.east_m, point.north_m) for point in found.points])


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(st.floats(-60, 60), st.floats(-60, 60), st.floats(2, 25)), min_size=1, max_size=6))
def test_no_route_ever_leaves_the_fence(discs: list[tuple[float, float, float]]) -> None:
    fence = Fence((box(-90, -70, 90, 70),), tuple(disc(*one) for one in discs))
    try:
        route = routed(fenced(POND, fence, "f"), (-80, 0), (80, 0))
    except NoRouteError:
        return
    assert shapely.box(-90, -70, 90, 70).contains(route)
    for east, north, radius_m in discs:
        middle = shapely.Point(east, north)  # a boat that begins or ends nearer than the clearance may
        ends_m = min(middle.distance(shapely.Point(end)) for end in (route.coords[0], route.coords[-1]))
        assert route.distance(middle) >= min(radius_m + CLEARANCE_M, ends_m) - TOUCH_M


def test_the_boat_must_be_inside_of_every_inclusion() -> None:
    fence = Fence((box(-80, -40, 80, 40),), (disc(0, 0, 70, inclusion=True),))
    route = routed(fenced(POND, fence, "f"), (-60, 0), (60, 0))
    assert max(math.hypot(*corner) for corner in route.coords) <= 70.0
    with pytest.raises(StartBlocked, match="lies in the water outside the fence"):
        routed(fenced(POND, fence, "f"), (-75, 0), (60, 0))


@pytest.mark.parametrize(
    ("fence", "said"),
    [
        (Fence((box(-60, -60, -20, 60), box(20, -60, 60, 60))), "no water in common"),
        (
            Fence((FencePolygon((place(0, 0), place(9, 9), place(9, 0), place(0, 9))),)),
            "fence polygon 1: not a valid",
        ),
        (Fence((box(-200, -200, 200, 200, inclusion=False),)), "leaves no water of Pond"),
        (
            Fence(circles=(FenceCircle(LatLon(10.0, 10.0), 50.0),)),
            "fence circle 1: 10.000000,10.000000 is nowhere near",
        ),
    ],
)
def test_a_fence_that_cannot_be_sailed_in_is_refused_by_name(fence: Fence, said: str) -> None:
    with pytest.raises(MapError, match=said) as told:
        fenced(POND, fence, "pond-fence.geojson")
    assert str(told.value).startswith("pond-fence.geojson: ")


def test_the_area_of_a_fence_is_its_inclusions_together_without_what_a_true_circle_covers() -> None:
    fence = Fence((box(-60, -20, 0, 20), box(-10, -20, 60, 20)), (disc(30, 0, 10.0),))
    area = fence_area(SEA, fence, "f")
    assert area.area == pytest.approx(120.0 * 40.0 - math.pi * 100.0, abs=0.2)
    angles = [math.pi * n / 64.0 for n in range(128)]
    inside = [shapely.Point(30 + 9.999 * math.cos(a), 9.999 * math.sin(a)) for a in angles]
    assert not any(area.contains(at) for at in inside)
    whole = fence_area(SEA, Fence((), (disc(0, 0, 10.0, inclusion=True),)), "f")
    assert whole.within(shapely.Point(0, 0).buffer(10.0, quad_segs=256))
