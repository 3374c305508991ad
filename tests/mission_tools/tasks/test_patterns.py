"""Search patterns, by hand and by their definition."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
from task_waters import basin

from companion.core.geo import Point
from mission_tools.errors import UsageError
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.survey.patterns import PatternName, pattern
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.survey.survey import survey

SEA = [shapely.box(-200.0, -200.0, 200.0, 200.0)]
DATUM = np.array([20.0, -30.0])


@pytest.mark.parametrize("course_deg", [0.0, 90.0, 200.0])
def test_an_expanding_square_has_legs_of_one_one_two_two_spacings_to_starboard(course_deg: float) -> None:
    (visit,) = pattern("expanding-square", DATUM, math.radians(course_deg), 10.0, SEA)[:1]
    assert visit.points[0] == pytest.approx(DATUM)
    steps = np.diff(visit.points, axis=0)[:8]
    assert np.hypot(*steps.T) == pytest.approx([10.0, 10.0, 20.0, 20.0, 30.0, 30.0, 40.0, 40.0])
    courses = np.degrees(np.arctan2(steps[:, 0], steps[:, 1]))
    turned = (courses - course_deg - 90.0 * np.arange(8) + 180.0) % 360.0 - 180.0
    assert turned == pytest.approx(np.zeros(8), abs=1e-6)


@pytest.mark.parametrize("course_deg", [0.0, 135.0])
def test_a_spiral_begins_on_its_course_and_grows_by_a_spacing_a_turn(course_deg: float) -> None:
    (visit,) = pattern("spiral", DATUM, math.radians(course_deg), 10.0, SEA)[:1]
    out = visit.points - DATUM
    radius_m, bearing = np.hypot(*out.T), np.unwrap(np.arctan2(out[1:, 0], out[1:, 1]))
    turn = bearing - math.radians(course_deg)
    turn -= math.tau * round((turn[0] - math.radians(20.0)) / math.tau)
    assert radius_m[1:-1] == pytest.approx(10.0 * turn[:-1] / math.tau)  # the last is where the sea ends
    assert radius_m[0] == 0.0
    sides = np.diff(visit.points, axis=0)
    assert np.all(sides[:-1, 0] * sides[1:, 1] - sides[:-1, 1] * sides[1:, 0] < 0.0)  # to starboard


@pytest.mark.parametrize("name", ["expanding-square", "spiral"])
def test_a_pattern_covers_the_water_in_order_and_goes_round_land(name: PatternName) -> None:
    island = shapely.box(80.0, 30.0, 110.0, 60.0)
    chart = basin(island)
    settings = SurveySettings(
        footprint_m=20.0,
        overlap=0.3,
        pattern=name,
        datum=Point(40.0, 60.0),
        plan=PlanSettings(clearance_m=2.0),
    )
    found = survey(chart, Point(10.0, 10.0), settings)
    assert found.coverage > 0.97
    assert found.route.min_clearance_m(chart) >= 2.0 * (1.0 - 1e-6)
    tracks = [leg for leg in found.route.legs if leg.kind == "track"]
    assert found.tracks == len(tracks) > 3
    assert tracks[0].points[0] == Point(40.0, 60.0)
    outward_m = [max(abs(at.north_m - 40.0), abs(at.east_m - 60.0)) for leg in tracks for at in leg.points]
    assert all(later > earlier - 15.0 for earlier, later in pairwise(outward_m))
    middle = survey(chart, None, replace(settings, datum=None)).route.points[0]
    assert math.dist((middle.north_m, middle.east_m), (50.0, 100.0)) < 40.0


def test_a_pattern_with_far_too_many_turns_is_refused() -> None:
    with pytest.raises(UsageError, match=r"a spiral with 0\.01 m from line to line has far too many turns"):
        pattern("spiral", DATUM, 0.0, 0.01, SEA)
