"""The benchmark of surveys, on a basin whose plain lines are known."""

import pytest
import shapely
from task_waters import basin

from benchmarks.planning.survey import described, seen_twice
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.survey.survey import survey


@pytest.mark.slow
def test_the_parts_of_a_survey_sum_to_its_length_over_plain_lines() -> None:
    found = survey(
        basin(shapely.box(80.0, 40.0, 100.0, 60.0)),
        None,
        SurveySettings(footprint_m=20.0, plan=PlanSettings(clearance_m=4.0)),
    )
    plain_m = (200.0 * 100.0 - 20.0 * 20.0) / 20.0
    said = described(found)
    ratio = float(said.split(" × plain")[0].split("= ")[1])
    assert ratio == pytest.approx(found.route.length_m / plain_m, abs=0.005)
    parts = said.split("(")[1].split(";")[0].split(", ")
    assert sum(float(part.split()[-1]) for part in parts) == pytest.approx(100.0 * ratio, abs=0.3)
    assert 0.0 < seen_twice(found) < 0.5
