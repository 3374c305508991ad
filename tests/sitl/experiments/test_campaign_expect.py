from typing import Any

import pytest

from sitl.experiments.campaign.expect import Expectation, Statistic, judge

TABLE: list[dict[str, Any]] = [
    {"course": "straight", "seed": 1, "rms": 0.1, "done": True, "over": None},
    {"course": "straight", "seed": 2, "rms": 0.3, "done": True, "over": None},
    {"course": "zigzag", "seed": 1, "rms": 0.5, "done": False, "over": 0.2},
]


@pytest.mark.parametrize(
    ("of", "value"), [("mean", 0.3), ("median", 0.3), ("smallest", 0.1), ("largest", 0.5), ("deviation", 0.2)]
)
def test_statistics_are_over_all_runs(of: Statistic, value: float) -> None:
    (verdict,) = judge([Expectation(figure="rms", of=of, at_most=value + 1e-9)], TABLE)
    assert verdict.value == pytest.approx(value)
    assert verdict.is_met
    assert not judge([Expectation(figure="rms", of=of, at_most=value - 1e-6)], TABLE)[0].is_met


def test_where_picks_runs_and_each_judges_every_group() -> None:
    (picked,) = judge([Expectation(figure="rms", where={"course": "straight"}, at_most=0.2)], TABLE)
    assert picked.runs == 2
    assert picked.value == pytest.approx(0.2)
    assert picked.group == "course straight"
    each = judge([Expectation(figure="rms", each="course", at_most=0.4)], TABLE)
    assert [(verdict.group, verdict.is_met) for verdict in each] == [
        ("course straight", True),
        ("course zigzag", False),
    ]
    among = judge([Expectation(figure="rms", where={"seed": [1, 7]}, at_most=1.0)], TABLE)
    assert among[0].runs == 2


def test_a_run_without_the_figure_is_no_run_that_meets_it() -> None:
    (verdict,) = judge([Expectation(figure="over", at_most=1.0)], TABLE)
    assert (verdict.value, verdict.missing, verdict.is_met) == (None, 2, False)


def test_both_bounds_hold() -> None:
    def met(low: float, high: float) -> bool:
        return judge([Expectation(figure="rms", at_least=low, at_most=high)], TABLE)[0].is_met

    assert met(0.2, 0.4)
    assert not met(0.35, 0.4)
    assert not met(0.2, 0.25)


def test_a_figure_may_be_bounded_by_that_of_other_runs() -> None:
    def verdicts(times: float) -> list[bool]:
        expectation = Expectation(
            figure="rms", each="course", against={"course": "straight"}, at_most_times=times
        )
        return [verdict.is_met for verdict in judge([expectation], TABLE)]

    assert verdicts(2.0) == [True, False]  # 0.2 and 0.5 against 0.2
    assert verdicts(2.6) == [True, True]
    assert verdicts(0.9) == [False, False]
    nobody = Expectation(figure="rms", against={"course": "circle"}, at_most_times=9.0)
    assert not judge([nobody], TABLE)[0].is_met
    with pytest.raises(ValueError, match="at_most_times and against together"):
        Expectation(figure="rms", at_most_times=2.0)
