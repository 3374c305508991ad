"""Ranges become cells on the chart, that have to be seen twice, and fade."""

import math
from typing import Any

import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.maps.chart import Chart, Feature, build_chart
from mission_tools.watch.sightings import FADE_S, Echo, Sightings, echoes_of

FRAME = LocalFrame(LatLon(50.0, 10.0))
HERE = Point(0.0, 0.0)
AHEAD = Echo(0.0, 4.0, True)


def chart(*features: Feature) -> Chart:
    return build_chart("pond", FRAME, shapely.box(-50, -50, 50, 50), features)


def sector_message(**changed: float) -> dict[str, Any]:
    distances = [65535] * 72
    distances[0], distances[18] = 400, 501
    message = {
        "distances": distances,
        "increment": 5,
        "increment_f": 5.0,
        "angle_offset": 0.0,
        "min_distance": 20,
        "max_distance": 500,
        "frame": 12,
    }
    return message | changed


def test_sectors_are_counted_from_the_bow() -> None:
    echoes = echoes_of("OBSTACLE_DISTANCE", sector_message(), heading_rad=0.5)
    assert [(echo.range_m, echo.is_hit) for echo in echoes] == [(4.0, True), (5.0, False)]
    assert [echo.bearing_rad for echo in echoes] == pytest.approx([0.5, 0.5 + 0.5 * math.pi])


def test_sectors_of_a_global_frame_are_counted_from_north_and_the_offset_is_added() -> None:
    message = sector_message(frame=0, angle_offset=10.0, increment_f=0.0)
    assert [echo.bearing_rad for echo in echoes_of("OBSTACLE_DISTANCE", message, 0.5)] == pytest.approx(
        [math.radians(10.0), math.radians(100.0)]
    )
    assert echoes_of("OBSTACLE_DISTANCE", sector_message(frame=1), 0.5) == []


def test_sectors_may_be_fractions_of_a_degree_wide() -> None:
    message = sector_message(increment=0, increment_f=2.5)
    assert [echo.bearing_rad for echo in echoes_of("OBSTACLE_DISTANCE", message, 0.0)] == pytest.approx(
        [0.0, math.radians(45.0)]
    )


def test_a_sector_that_says_the_same_again_is_no_new_measurement() -> None:
    before, now = sector_message(), sector_message()
    assert echoes_of("OBSTACLE_DISTANCE", now, 0.0, before) == []
    now["distances"][0] = 398
    assert echoes_of("OBSTACLE_DISTANCE", now, 0.0, before) == [Echo(0.0, 3.98, True)]


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({"orientation": 2, "current_distance": 300}, [Echo(0.5 + 0.5 * math.pi, 3.0, True)]),
        ({"orientation": 0, "current_distance": 501}, [Echo(0.5, 5.0, False)]),
        ({"orientation": 0, "current_distance": 10}, []),
        ({"orientation": 7, "current_distance": 300}, [Echo(0.5 + 1.75 * math.pi, 3.0, True)]),
        ({"orientation": 8, "current_distance": 300}, []),  # rolled on its side
        ({"orientation": 25, "current_distance": 300}, []),  # an echo sounder looks down
        (
            {
                "orientation": 100,
                "current_distance": 300,
                "quaternion": [math.cos(0.1), 0.0, 0.0, math.sin(0.1)],
            },
            [Echo(0.7, 3.0, True)],
        ),
    ],
)
def test_a_single_ranger_looks_where_it_is_mounted(fields: dict[str, Any], expected: list[Echo]) -> None:
    message = {"min_distance": 20, "max_distance": 500} | fields
    found = echoes_of("DISTANCE_SENSOR", message, heading_rad=0.5)
    assert [(e.range_m, e.is_hit) for e in found] == [(e.range_m, e.is_hit) for e in expected]
    assert [e.bearing_rad for e in found] == pytest.approx([e.bearing_rad for e in expected])


def test_what_is_seen_once_may_be_a_ghost_and_what_is_seen_twice_is_there() -> None:
    seen = Sightings(chart())
    seen.take([AHEAD, AHEAD], HERE, 0.0)
    assert seen.area(0.0).is_empty
    seen.take([AHEAD], HERE, 0.2)
    assert seen.area(0.2).contains(shapely.Point(0.1, 4.1))
    assert seen.area(0.2).area == pytest.approx(0.25)


def test_what_was_seen_fades() -> None:
    seen = Sightings(chart())
    for time_s in (0.0, 0.2):
        seen.take([AHEAD], HERE, time_s)
    assert not seen.area(0.1 + FADE_S).is_empty
    assert seen.area(0.2 + FADE_S).is_empty


def test_a_ray_that_passes_through_takes_it_away_again() -> None:
    seen = Sightings(chart())
    for time_s in (0.0, 0.2):
        seen.take([AHEAD], HERE, time_s)
    seen.take([Echo(0.0, 5.0, False)], HERE, 0.4)
    assert seen.area(0.4).is_empty
    for time_s in (0.6, 0.8):
        seen.take([AHEAD], HERE, time_s)
    seen.take([Echo(0.5, 5.0, False), Echo(math.pi, 5.0, False), Echo(0.0, 4.2, True)], HERE, 1.0)
    assert not seen.area(1.0).is_empty


@pytest.mark.parametrize(
    ("bearing_deg", "range_m", "passes"),
    [
        (45.0, 6.0, True),
        (45.0, 4.3, False),  # it ends at the cell
        (48.0, 6.0, True),  # 0.2 m beside its middle
        (52.0, 6.0, False),  # 0.5 m
        (38.0, 6.0, False),
        (-45.0, 6.0, False),
        (135.0, 6.0, False),
        (225.0, 6.0, False),  # behind
    ],
)
def test_a_ray_weakens_the_cells_in_its_way_and_no_others(
    bearing_deg: float, range_m: float, passes: bool
) -> None:
    seen = Sightings(chart())
    for time_s in (0.0, 0.2):
        seen.take([Echo(math.radians(45.0), 4.0, True)], HERE, time_s)  # to 2.75 m north, 2.75 m east
    seen.take([Echo(math.radians(bearing_deg), range_m, False)], HERE, 0.4)
    assert seen.area(0.4).is_empty is passes


def test_the_charts_own_shore_is_not_news() -> None:
    island = Feature("island", "island", shapely.box(-3.0, 4.0, 3.0, 8.0))
    seen = Sightings(chart(island))
    for time_s in (0.0, 0.2):
        seen.take([AHEAD, Echo(0.0, 2.5, True)], HERE, time_s)
    assert seen.area(0.2).is_empty


def test_near_cells_are_one_obstacle_and_far_ones_two() -> None:
    seen = Sightings(chart())
    rays = [Echo(math.atan2(east, 6.0), math.hypot(east, 6.0), True) for east in (-5.0, -3.6, 3.6, 5.0)]
    for time_s in (0.0, 0.2):
        seen.take(rays, HERE, time_s)
    parts = shapely.get_parts(seen.area(0.2))
    assert len(parts) == 2
    assert all(part.bounds[2] - part.bounds[0] > 1.4 for part in parts)


def test_what_is_taken_in_meanwhile_does_not_disturb_the_area(monkeypatch: pytest.MonkeyPatch) -> None:
    """The area is drawn in a thread, and messages keep coming."""
    seen = Sightings(chart())
    for time_s in (0.0, 0.2):
        seen.take([AHEAD, Echo(1.0, 4.0, True)], HERE, time_s)
    box, bearings = shapely.box, iter((2.0, 3.0))

    def box_and_message(*sides: float) -> shapely.Polygon:
        seen.take([Echo(next(bearings), 4.0, True)], HERE, 0.3)
        return box(*sides)

    monkeypatch.setattr(shapely, "box", box_and_message)
    assert len(shapely.get_parts(seen.area(0.3))) == 2
