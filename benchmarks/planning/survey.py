"""How much does a survey cover, how long is it beside plain lines, where is the rest, and how long does it
take to plan, on real lakes with islands?

    python -m benchmarks survey                            # the mill pond, lakes of tests/data/shores
    python -m benchmarks.planning.survey MAP FOOTPRINT …   # other maps, the footprint in metres

Plain lines are parallel lines at the spacing over all the water that is to be covered, without transits and
without passes along the shore. Their length is the area over the spacing, whatever their course. The parts of
a survey are given in percent of that: tracks, passes along the shore, transits straight from place to place
(turns between tracks among them), and transits round land. Coverage is measured apart from the planner, by
areas of polygons with finer arcs. What is seen twice lies within reach of tracks as well as of passes.
"""

import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import shapely

from benchmarks.measure import Row, alone, cpu_seconds
from companion.core.geo import Point
from mission_tools.drawing.draw import swath_of
from mission_tools.maps import Chart, load_source
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.survey.coverage import SAMPLES, is_covered, sample_points
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.survey.survey import Survey, survey
from mission_tools.tasks.task_route import TaskLeg

SHORE = Path("tests/data/shores")
LAKES = (
    ("lake", 30.0),
    (str(SHORE / "pond_two_islands_nh.geojson"), 12.0),
    (str(SHORE / "pond_two_islands_nh.geojson"), 24.0),
    (str(SHORE / "lake_squam_nh.geojson"), 100.0),
    (str(SHORE / "lake_winnipesaukee_nh.geojson"), 200.0),
    (str(SHORE / "lake_winnipesaukee_nh.geojson"), 400.0),
)
OVERLAP = 0.1
CLEARANCE_M = 4.0
ROUNDS = 3
_ARC = 16  # segments of a quarter circle


def rows() -> list[Row]:
    """A row a lake."""
    return [row_of(source, footprint_m) for source, footprint_m in LAKES]


def row_of(source: str, footprint_m: float) -> Row:
    """The CPU time to plan, and the length and coverage in the note."""
    chart = load_source(source).chart
    settings = SurveySettings(
        footprint_m=footprint_m, overlap=OVERLAP, plan=PlanSettings(clearance_m=CLEARANCE_M)
    )
    planned = survey(chart, None, settings)
    plan_it = partial(survey, chart, None, settings)
    seconds = [cpu_seconds(plan_it) for _ in range(ROUNDS)]
    question = f"CPU time to plan {Path(source).stem}, {chart.navigable.area / 1e4:.0f} ha, {footprint_m:g} m"
    note = f"{100.0 * covered(chart, planned):.2f} % covered; {described(planned)}"
    return alone(question, "s", seconds, note)


def described(planned: Survey) -> str:
    """The length over that of plain lines, and its parts in percent of them."""
    route, plain_m = planned.route, planned.plain_m
    straight = [leg for leg in route.legs if leg.kind == "transit" and len(leg.points) == 2]
    straight_m = sum(leg.length_m for leg in straight)
    parts = {
        "tracks": route.length_of_m("track"),
        "passes": route.length_of_m("shore"),
        "straight transits": straight_m,
        "round land": route.length_of_m("transit") - straight_m,
    }
    shares = ", ".join(f"{name} {100.0 * length_m / plain_m:.1f}" for name, length_m in parts.items())
    return (
        f"{route.length_m / 1e3:.1f} km = {route.length_m / plain_m:.3f} × plain lines ({shares}; "
        f"{100.0 * seen_twice(planned):.0f} % seen twice); "
        f"{len(route.points)} waypoints"
    )


def seen_twice(planned: Survey) -> float:
    """The share of the target within half a footprint of tracks and of passes."""
    points = sample_points(planned.target, SAMPLES)
    seen = [
        is_covered(points, _lines([leg for leg in planned.route.legs if leg.kind == kind]), planned.swath_m)
        for kind in ("track", "shore")
    ]
    return float(np.mean(seen[0] & seen[1]))


def covered(chart: Chart, planned: Survey) -> float:
    """The share of the reachable water, widened by half a footprint, that lies within half a footprint."""
    room = chart.navigable.buffer(-CLEARANCE_M, quad_segs=_ARC)
    largest = max(shapely.get_parts(room), key=lambda part: part.area)
    target = largest.buffer(0.5 * planned.swath_m, quad_segs=_ARC).intersection(chart.navigable)
    swath = swath_of(planned.route.points, planned.swath_m)
    return float(swath.intersection(target).area / target.area)


def _lines(legs: Sequence[TaskLeg]) -> shapely.MultiLineString:
    def xy(point: Point) -> tuple[float, float]:
        return point.east_m, point.north_m

    return shapely.MultiLineString([[xy(point) for point in leg.points] for leg in legs])


def main(arguments: Sequence[str]) -> int:
    """A line a map."""
    pairs = list(zip(arguments[::2], map(float, arguments[1::2]), strict=True)) or LAKES
    for source, footprint_m in pairs:
        row = row_of(source, footprint_m)
        sys.stdout.write(f"{row.question}: {row.ours:.2f} s; {row.note}\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
