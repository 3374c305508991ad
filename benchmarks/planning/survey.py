"""How much does a survey cover, how long is it, and how long does it take to plan, on real lakes with
islands?

Coverage is measured apart from the planner, by areas of polygons with finer arcs. The length is compared with
the tracks, the passes along the shore and a lower bound of the transits between them (`least_transits_m`).
"""

from functools import partial
from pathlib import Path

import shapely

from benchmarks.measure import Row, alone, cpu_seconds
from mission_tools.drawing.draw import swath_of
from mission_tools.maps import Chart, load_source
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.survey.survey import Survey, survey

SHORE = Path("tests/data/shores")
LAKES = (
    ("pond_two_islands_nh", "pond, 33 ha, 2 islands", 12.0),
    ("lake_squam_nh", "Squam, 27 km², 14 islands", 100.0),
    ("lake_winnipesaukee_nh", "Winnipesaukee, 186 km², 68 islands", 400.0),
)
OVERLAP = 0.1
ROUNDS = 5
_ARC = 16  # segments of a quarter circle


def rows() -> list[Row]:
    """A row a lake."""
    found: list[Row] = []
    for name, title, footprint_m in LAKES:
        path = SHORE / f"{name}.geojson"
        chart = load_source(str(path)).chart
        settings = SurveySettings(
            footprint_m=footprint_m,
            overlap=OVERLAP,
            plan=PlanSettings(clearance_m=4.0),
        )
        planned = survey(chart, None, settings)
        plan_it = partial(survey, chart, None, settings)
        seconds = [cpu_seconds(plan_it) for _ in range(ROUNDS)]
        note = (
            f"{planned.route.length_m / 1e3:.1f} km, {planned.length_ratio:.3f} × the bound; "
            f"{100.0 * covered(chart, planned):.2f} % covered"
        )
        found.append(alone(f"CPU time to plan {title}, footprint {footprint_m:g} m", "s", seconds, note))
    return found


def covered(chart: Chart, planned: Survey) -> float:
    """The share of the reachable water, widened by half a footprint, that lies within half a footprint."""
    room = chart.navigable.buffer(-4.0, quad_segs=_ARC)
    largest = max(shapely.get_parts(room), key=lambda part: part.area)
    target = largest.buffer(0.5 * planned.swath_m, quad_segs=_ARC).intersection(chart.navigable)
    swath = swath_of(planned.route.points, planned.swath_m)
    return float(swath.intersection(target).area / target.area)
