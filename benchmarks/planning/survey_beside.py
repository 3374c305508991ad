"""How long is a survey beside another program's coverage route of the same polygon at the same spacing?

    python -m benchmarks.planning.survey_beside MAP SPACING SIMPLIFIED FIELD.wkt     # write the polygon
    python -m benchmarks.planning.survey_beside MAP SPACING SIMPLIFIED ROUTE.wkt …   # compare routes in it

The polygon is the water of MAP that is 4 m clear of its shores, with corners only where they leave the line
by more than SIMPLIFIED metres, and without islands of less than a quarter of a square of the spacing. Both
may sail anywhere in it. A route is a LINESTRING in the polygon's metres: of Fields2Cover what
`Route.asLineString().exportToWkt()` gives. Of several the shortest counts that covers as much as ours, to a
percent.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import shapely

from companion.core.geo import LatLon, LocalFrame
from mission_tools.maps import Feature, build_chart, load_source
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.room import water_clear_of_shores
from mission_tools.tasks.survey.coverage import SAMPLES, is_covered, sample_points
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.survey.survey import survey

CLEARANCE_M = 4.0
SHARE = 0.01  # of the polygon, that coverage may be less by


def field_of(source: str, spacing_m: float, simplified_m: float) -> shapely.Polygon:
    """The polygon of a map."""
    water = max(water_clear_of_shores(load_source(source).chart, CLEARANCE_M), key=lambda part: part.area)
    water = water.simplify(simplified_m)
    rings = [ring for ring in water.interiors if shapely.Polygon(ring).area > 0.25 * spacing_m**2]
    return shapely.set_precision(shapely.Polygon(water.exterior, rings), 0.01)


def main(arguments: Sequence[str]) -> int:
    """Write the polygon, or print a line."""
    source, spacing_m, simplified_m = arguments[0], float(arguments[1]), float(arguments[2])
    field, paths = field_of(source, spacing_m, simplified_m), [Path(one) for one in arguments[3:]]
    if len(paths) == 1 and not paths[0].exists():
        paths[0].write_text(shapely.to_wkt(field, rounding_precision=2))
        return 0
    islands = [Feature(f"{n}", "island", shapely.Polygon(ring)) for n, ring in enumerate(field.interiors)]
    chart = build_chart(
        Path(source).stem, LocalFrame(LatLon(50.0, 0.0)), shapely.Polygon(field.exterior), islands
    )
    planned = survey(chart, None, SurveySettings(spacing_m=spacing_m, plan=PlanSettings(clearance_m=0.01)))
    places = sample_points(field, SAMPLES)
    own = shapely.LineString([(point.east_m, point.north_m) for point in planned.route.points])
    least = float(np.mean(is_covered(places, own, spacing_m))) - SHARE
    routes = [shapely.from_wkt(path.read_text()) for path in paths]
    shares = [float(np.mean(is_covered(places, route, spacing_m))) for route in routes]
    fair = [(route.length, share) for route, share in zip(routes, shares, strict=True) if share >= least]
    length_m, share = min(fair, default=(float("nan"), max(shares, default=0.0)))
    sys.stdout.write(
        f"{Path(source).stem}, {spacing_m:g} m, {len(field.interiors)} islands: {own.length:.0f} m, "
        f"{least + SHARE:.2%} covered; other: {length_m:.0f} m, {share:.2%}; "
        f"ratio {own.length / length_m:.3f}\n"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
