"""Waters for the tests of tasks: a basin made up, and the real shores beside the project."""

from pathlib import Path

import shapely
from data_files import SHORES

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.maps import Chart, Feature, build_chart, load_source

POND = Path(__file__).parents[2] / "examples" / "maps" / "mill_pond.geojson"
FRAME = LocalFrame(LatLon(50.0, -1.2))


def basin(*islands: shapely.Polygon, width_m: float = 200.0, height_m: float = 100.0) -> Chart:
    """A rectangle of water with its south-west corner at the origin."""
    features = [Feature(f"island {n + 1}", "island", shape) for n, shape in enumerate(islands)]
    return build_chart("Basin", FRAME, shapely.box(0.0, 0.0, width_m, height_m), features)


def real_lake(name: str) -> Chart:
    """One of the real shores."""
    return load_source(str(SHORES / f"{name}.geojson")).chart


def route_line(points: tuple[Point, ...]) -> shapely.LineString:
    """A route as a shapely line."""
    return shapely.LineString([(point.east_m, point.north_m) for point in points])
