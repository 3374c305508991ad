"""A small survey sailed by the emulated boat: what it really covers, and that a seed repeats it."""

from dataclasses import replace

import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.drawing.draw import draw_survey
from mission_tools.maps import Feature, build_chart
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.survey.settings import SurveySettings, turn_radius_m
from sitl.experiments.survey_trial import SailedSurvey, sail_survey
from sitl.scenarios.scenario import load_scenario

pytestmark = pytest.mark.slow

ISLAND = shapely.box(30.0, 20.0, 42.0, 30.0)
SETTINGS = SurveySettings(
    footprint_m=10.0,
    overlap=0.15,
    plan=PlanSettings(clearance_m=4.0),
    turn_radius_m=turn_radius_m(2.0, 0.65, 0.8),
    is_return=True,
)


CHART = build_chart(
    "Basin",
    LocalFrame(LatLon(50.0, -1.2)),
    shapely.box(0.0, 0.0, 80.0, 50.0),
    [Feature("Islet", "island", ISLAND)],
)


def sailed_basin() -> SailedSurvey:
    """80 × 50 m with an island, the boat in its south-west corner."""
    return sail_survey(replace(load_scenario("lake"), chart=CHART, start=Point(8.0, 8.0)), SETTINGS)


def test_the_boat_covers_what_was_planned_and_touches_nothing() -> None:
    first, second = sailed_basin(), sailed_basin()
    assert first.planned.coverage >= 0.995
    assert first.coverage >= 0.98
    assert first.result.groundings == 0
    assert first.result.completed
    assert first.result.path_length_m <= 1.1 * first.planned.route.length_m
    assert (first.result.state_hash, first.coverage) == (second.result.state_hash, second.coverage)
    figure = draw_survey(CHART, first.planned, first.track, title="Basin", subtitle="a test")
    legend = figure.axes[0].get_legend()
    assert legend is not None
    named = [
        "planned: tracks",
        "planned: along the shore",
        "planned: transits",
        "sailed",
        "covered",
        "missed",
    ]
    assert [text.get_text() for text in legend.get_texts()] == named
