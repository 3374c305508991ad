"""NEES and NIS: the arithmetic, and that the boat's filter is not over-confident."""

import math

import numpy as np
import pytest

from benchmarks.estimation.consistency import (
    CHANNELS,
    NAV,
    Sailed,
    average_nees,
    average_nis,
    bounds,
    campaign,
    nees,
    nis,
    table,
)
from sitl.world.truth import Truth


@pytest.mark.parametrize(
    ("freedom", "runs", "low", "high"),
    [(2, 50, 74.22, 129.56), (1, 20, 9.591, 34.170), (2, 200, 346.48, 457.31)],  # tables of χ²
)
def test_bounds_are_those_of_tables(freedom: int, runs: int, low: float, high: float) -> None:
    assert bounds(freedom, runs) == pytest.approx((low / runs, high / runs), rel=2e-3)


def one_row(variances: object, *, surge_m_s: float = 0.0, is_still_air: bool = True, **off: float) -> Sailed:
    """A run of one row, its estimate so far off a truth of zeros, heading north."""
    nav, state = np.array([[off.get(name, 0.0) for name in NAV]]), np.zeros((1, 13))
    state[0, 3] = surge_m_s
    covariance = np.asarray(variances, dtype=np.float64)[None]
    return Sailed(np.zeros((1, len(Truth._fields))), nav, state, covariance, np.empty(0), is_still_air)


def test_nees_of_known_errors_is_as_calculated_by_hand() -> None:
    covariance = np.diag([0.04, 0.01, 0.09, 0.02, 0.03, 0.05, 0.12] + [1.0] * 6)
    covariance[0, 1] = covariance[1, 0] = 0.01
    found = nees(
        one_row(
            covariance, surge_m_s=2.0, north_m=0.2, east_m=0.1, heading_rad=math.tau - 0.3, north_m_s=0.4,
            current_east_m_s=0.6,
        )
    )  # fmt: skip
    inverse = np.linalg.inv([[0.04, 0.01], [0.01, 0.01]])
    assert found["position"][0] == pytest.approx(np.array([0.2, 0.1]) @ inverse @ np.array([0.2, 0.1]))
    assert found["heading"][0] == pytest.approx(1.0)
    assert found["velocity"][0] == pytest.approx(0.16 / (0.02 + 0.05))
    assert found["current"][0] == pytest.approx(0.36 / 0.12)


def test_heading_errors_count_in_the_variance_of_the_velocity_across() -> None:
    covariance = np.diag([1.0, 1.0, 0.01, 0.02, 0.03, 0.05, 0.12] + [1.0] * 6)
    found = nees(one_row(covariance, surge_m_s=2.0, east_m_s=0.3))
    assert found["velocity"][0] == pytest.approx(0.09 / (0.03 + 0.12 + 4.0 * 0.01))


def test_the_current_is_not_judged_in_wind() -> None:
    assert "current" not in nees(one_row(np.eye(13), is_still_air=False))


def test_nis_counts_pairs_of_measurements_once_and_each_only_once() -> None:
    rows = 205
    innovations = np.zeros((rows, len(CHANNELS), 3))
    innovations[:, :, 0] = 17.0  # measured before the runs are judged
    innovations[:, :, 1:] = 1.0, 0.5
    innovations[202:, :, 0] = 20.2
    for number, name in enumerate(CHANNELS):
        innovations[202:, number, 1] = 3.0 if name == "position_east" else 2.0
    found = nis(innovations)
    assert found["position"] == (8.0 + 18.0, 1)
    assert found["compass"] == (8.0, 1)
    averages = average_nis([found, found])
    assert averages["position"].mean == pytest.approx(26.0)


def test_averages_are_over_runs_and_shares_of_the_time() -> None:
    runs = [{"heading": np.full(400, value)} for value in (0.5, 1.5, 0.0, 2.0)]
    runs[0]["heading"] = np.concatenate((np.full(300, 0.5), np.full(100, 30.0)))
    one = average_nees(runs)["heading"]
    assert one.over_time.tolist() == [1.0] * 100 + [8.375] * 100  # the first 20 s do not count
    assert one.mean == pytest.approx(4.6875)
    assert (one.within_share, one.above_share) == (0.5, 0.5)
    assert "| known, 4 | NEES | heading | 4.69 | 0.11 to 2.78 | 50 % | 50 % |" in table(
        {"known": ({"heading": one}, {})}
    )


@pytest.mark.parametrize("receiver", ["standalone", "sbas", "rtk"])
def test_with_every_receiver_the_filter_is_as_certain_as_it_may_be_on_other_hulls(receiver: str) -> None:
    found, _ = campaign(range(1, 5), "other", receiver)
    for name in ("position", "velocity"):
        assert 0.4 < found[name].mean / found[name].freedom < 2.0, name
    for name in ("heading", "current"):
        assert found[name].mean / found[name].freedom < 2.0, name
