"""What the watcher makes of messages and of a chart."""

import math
from typing import Any

import shapely

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.maps.chart import CLEARANCE, Feature, build_chart
from mission_tools.mission.mission import Mission, MissionItem
from mission_tools.watch.watcher import Watcher

FRAME = LocalFrame(LatLon(50.0, 10.0))


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


def test_a_detour_keeps_the_clearance_that_a_feature_asks_for() -> None:
    wreck = shapely.box(12.0, 18.0, 30.0, 22.0)  # to the right; what is seen ahead reaches far to the left
    chart = build_chart(
        "pond",
        FRAME,
        shapely.box(-60.0, -60.0, 60.0, 60.0),
        [Feature("wreck", "obstacle", wreck, {CLEARANCE: 10.0})],
    )
    goal = MissionItem.at(FRAME.to_global(Point(40.0, 0.0)))
    watcher = Watcher(chart, Mission((goal,), home=FRAME.origin), 2.0)
    here = {"lat": 500000000, "lon": 100000000, "hdg": 65535}
    for time_s, range_cm in ((0.0, 1900), (0.2, 1896)):
        watcher.take("GLOBAL_POSITION_INT", here, time_s)
        watcher.take("ATTITUDE", {"yaw": 0.0}, time_s)
        watcher.take("OBSTACLE_DISTANCE", sectors(range_cm), time_s)
    found = watcher.look(0, 0.2)
    assert found is not None
    way = [Point(0.0, 0.0), *(FRAME.to_local(place) for place in found.places)]
    line = shapely.LineString([(point.east_m, point.north_m) for point in way])
    assert line.distance(chart.features[0].shape) >= 10.0 - 0.01
    assert math.isclose(way[-1].north_m, 40.0, abs_tol=0.01)


def test_a_heading_of_the_position_message_counts_where_there_is_no_attitude() -> None:
    chart = build_chart("sea", FRAME, shapely.box(-60.0, -60.0, 60.0, 60.0), ())
    goal = MissionItem.at(FRAME.to_global(Point(0.0, 40.0)))
    watcher = Watcher(chart, Mission((goal,), home=FRAME.origin), 2.0)
    here = {"lat": 500000000, "lon": 100000000, "hdg": 9000}
    for time_s, range_cm in ((0.0, 1900), (0.2, 1896)):
        watcher.take("GLOBAL_POSITION_INT", here, time_s)
        watcher.take("OBSTACLE_DISTANCE", sectors(range_cm), time_s)
    assert watcher.look(0, 0.2) is not None, "seen to the east, on the way"


def test_without_any_heading_nothing_is_made_of_an_echo() -> None:
    chart = build_chart("sea", FRAME, shapely.box(-60.0, -60.0, 60.0, 60.0), ())
    goal = MissionItem.at(FRAME.to_global(Point(40.0, 0.0)))
    watcher = Watcher(chart, Mission((goal,), home=FRAME.origin), 2.0)
    for time_s, range_cm in ((0.0, 1900), (0.2, 1896)):
        watcher.take("GLOBAL_POSITION_INT", {"lat": 500000000, "lon": 100000000, "hdg": 65535}, time_s)
        watcher.take("OBSTACLE_DISTANCE", sectors(range_cm), time_s)
    assert watcher.look(0, 0.2) is None
