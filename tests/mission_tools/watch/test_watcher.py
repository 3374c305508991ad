"""What the watcher makes of messages and of a chart."""

import math
from typing import Any

import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.errors import NoRoute
from mission_tools.maps.chart import CLEARANCE, Feature, build_chart
from mission_tools.mission.mission import Mission, MissionItem
from mission_tools.watch.watcher import Watcher

FRAME = LocalFrame(LatLon(50.0, 10.0))
UNKNOWN = 65535
EAST = 9000
NORTHWARD, EASTWARD = Point(40.0, 0.0), Point(0.0, 40.0)


def sectors(range_cm: int) -> dict[str, Any]:
    distances = [65535] * 72
    for sector in (*range(62, 72), 0, 1, 2):
        distances[sector] = range_cm + sector % 2
    return {
        "distances": distances,
        "increment": 5,
        "increment_f": 5.0,
        "angle_offset": 0.0,
        "min_distance": 20,
        "max_distance": 2000,
        "frame": 12,
    }


def watching(goal: Point, *features: Feature) -> Watcher:
    """A watcher over a boat at the origin, which goes there."""
    chart = build_chart("pond", FRAME, shapely.box(-60.0, -60.0, 60.0, 60.0), features)
    mission = Mission((MissionItem.at(FRAME.to_global(goal)),), home=FRAME.origin)
    return Watcher(chart, mission, 2.0)


def see(watcher: Watcher, yaw: float | None = None, hdg: int = UNKNOWN, since_s: float = 0.0) -> float:
    """Something about 19 m before the bow, twice. Returns when."""
    for time_s, range_cm in ((since_s, 1900), (since_s + 0.2, 1896)):
        if yaw is not None:
            watcher.take("ATTITUDE", {"yaw": yaw}, time_s)
        watcher.take("GLOBAL_POSITION_INT", {"lat": 500000000, "lon": 100000000, "hdg": hdg}, time_s)
        watcher.take("OBSTACLE_DISTANCE", sectors(range_cm), time_s)
    return since_s + 0.2


def test_a_detour_keeps_the_clearance_that_a_feature_asks_for() -> None:
    wreck = shapely.box(12.0, 18.0, 30.0, 22.0)  # to the right; what is seen ahead reaches far to the left
    watcher = watching(NORTHWARD, Feature("wreck", "obstacle", wreck, {CLEARANCE: 10.0}))
    found = watcher.look(0, see(watcher, yaw=0.0))
    assert found is not None
    way = [Point(0.0, 0.0), *(FRAME.to_local(place) for place in found.places)]
    line = shapely.LineString([(point.east_m, point.north_m) for point in way])
    assert line.distance(wreck) >= 10.0 - 0.01
    assert math.isclose(way[-1].north_m, 40.0, abs_tol=0.01)


def test_a_heading_of_the_position_message_counts_where_there_is_no_attitude() -> None:
    watcher = watching(EASTWARD)
    assert watcher.look(0, see(watcher, hdg=EAST)) is not None
    watcher = watching(EASTWARD)
    assert watcher.look(0, see(watcher, yaw=0.0, hdg=EAST)) is None


def test_without_any_heading_nothing_is_made_of_an_echo() -> None:
    bearing = math.radians(UNKNOWN / 100.0)
    watcher = watching(Point(40.0 * math.cos(bearing), 40.0 * math.sin(bearing)))
    assert watcher.look(0, see(watcher)) is None


def test_a_way_that_is_closed_is_told_once_until_it_was_open_in_between() -> None:
    watcher = watching(Point(19.0, 0.0))
    now_s = see(watcher, yaw=0.0)
    with pytest.raises(NoRoute, match="lies on the last waypoint"):
        watcher.look(0, now_s)
    assert watcher.look(0, now_s) is None
    assert "lies on the last waypoint" in watcher.failure
    see(watcher, yaw=math.pi, since_s=100.0)
    watcher.take("GLOBAL_POSITION_INT", {"lat": 500000000, "lon": 100000000, "hdg": EAST}, 130.0)
    watcher.take("ATTITUDE", {"yaw": 0.0}, 130.0)
    assert watcher.look(0, 130.0) is None
    assert watcher.failure == ""
    now_s = see(watcher, yaw=0.0, since_s=131.0)
    with pytest.raises(NoRoute, match="lies on the last waypoint"):
        watcher.look(0, now_s)
