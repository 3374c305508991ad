"""The paper's experiment: its equations, its tables, and one of its cases sailed."""

import math
from itertools import pairwise

import pytest

from companion.core.geo import Point, distance_m, path_length_m
from sitl.experiments.paper import table
from sitl.experiments.paper.conditions import CASES, Method, conditions
from sitl.experiments.paper.run import paper_trials, planned, run_paper_trial
from sitl.experiments.paper.shore_steering import OnOff
from sitl.experiments.paper.step_response import GAIN_SETS, step_responses
from sitl.experiments.trial import Figures, TrialResult

pytestmark = pytest.mark.slow

FIGURES: Figures = {
    "case": "5", "method": str(Method.ON_OFF), "seed": 1, "current_m_s": 0.005, "planned_m": 0.8,
    "arrived": True, "time_s": 20.0, "length_m": 0.9, "collisions": 0, "off_plan_rms_m": 0.02,
}  # fmt: skip


def results() -> list[TrialResult]:
    """Two runs of case 5 by each of two methods; the PID's are shorter, faster and more alike."""
    strayed: Figures = {"time_s": 24.0, "length_m": 1.1, "off_plan_rms_m": 0.04, "collisions": 2}
    by_pid: Figures = {"method": str(Method.PID), "time_s": 18.0, "length_m": 0.85}
    again: Figures = {**by_pid, "seed": 2, "time_s": 19.0, "length_m": 0.86}
    changes: list[Figures] = [{}, {"seed": 2, "arrived": False, **strayed}, by_pid, again]
    return [TrialResult(number=1, ended="completed", figures={**FIGURES, **change}) for change in changes]


def test_equations_5_to_7_reproduce_the_papers_table_from_its_times() -> None:
    for case in CASES:
        for printed_cm, time_s in zip(table.PRINTED_CM[case], table.PRINTED_S[case], strict=True):
            assert table.equation_5_cm(time_s) == pytest.approx(printed_cm, abs=0.01)
    assert table.equation_6_cm(261.0) == pytest.approx(21.75)
    assert table.equation_7_cm(261.0) == pytest.approx(239.25)


def test_rows_have_means_sample_deviations_and_every_collision() -> None:
    on_off, by_pid = table.rows(results())
    assert (on_off.case, on_off.method, on_off.runs, on_off.arrived) == ("5", "A*", 2, 1)
    assert on_off.length_mean_m == pytest.approx(1.0)
    assert on_off.length_sd_m == pytest.approx(0.2 / math.sqrt(2.0))
    assert on_off.collisions == 2
    assert on_off.off_plan_rms_m == pytest.approx(math.sqrt((0.02**2 + 0.04**2) / 2.0))
    assert on_off.paper_length_cm == pytest.approx(4.5 * 22.0)
    assert by_pid.time_mean_s == pytest.approx(18.5)


def test_reductions_are_shares_and_negative_where_it_got_worse() -> None:
    better = table.reductions(table.rows(results()))["5"]
    assert better["length"] == pytest.approx(1.0 - 0.855 / 1.0)
    assert better["time SD"] == pytest.approx(1.0 - 1.0 / 4.0)
    worse = table.reductions(table.rows(results()), against=Method.PID, by=Method.ON_OFF)["5"]
    assert worse["length"] < 0.0


@pytest.mark.parametrize("case", CASES)
def test_plans_keep_off_the_obstacles_and_the_exact_one_is_the_shorter(case: str) -> None:
    lengths = []
    for is_exact in (False, True):
        points = planned(case, is_exact)
        chart = conditions(case, 1).chart
        assert all(chart.leg_clearance_m(a, b) > 0.05 for a, b in pairwise(points[1:])), points
        lengths.append(path_length_m(points))
    assert lengths[1] < lengths[0]


@pytest.mark.parametrize(("error_deg", "turn"), [(14.0, 0), (-14.0, 0), (16.0, 1000), (190.0, -1000)])
def test_on_off_turns_fully_outside_its_dead_zone(error_deg: float, turn: int) -> None:
    order = OnOff(conditions("5", 1)).order(math.radians(error_deg), 0.0)
    assert order.y == turn
    assert order.z == round(1000 * conditions("5", 1).vehicle.speed.cruise_throttle)


@pytest.mark.parametrize("method", [Method.ON_OFF, Method.PID_AHEAD, Method.EXACT])
def test_the_free_case_is_sailed_to_its_goal_by_every_method(method: Method) -> None:
    (trial,) = paper_trials([101], ["5"], [method])
    result = run_paper_trial(trial)
    goal = planned("5", method.is_exact)[-1]
    assert result.ended == "completed"
    east_m, north_m = result.track[-1]
    assert distance_m(Point(north_m, east_m), goal) < 0.15
    assert 0.6 < result.value("length_m") < 1.3
    assert result.value("time_s") > result.value("length_m") / 0.07
    assert result.value("collisions") == 0


def test_the_gain_set_that_the_paper_chose_settles_first() -> None:
    responses = step_responses()
    assert [response.gains for response in responses] == list(GAIN_SETS)
    settled = [response.settle_s for response in responses]
    assert None not in settled
    assert min(s for s in settled if s is not None) == settled[2]
    assert all(response.overshoot < 0.4 for response in responses)
