"""What a fix may be off by: the class of the solution, and what the receiver states."""

import math

import pytest

from companion.config.tuning import Estimation
from companion.core.geo import LatLon
from companion.core.readings import GnssFix
from companion.estimation.estimator import Estimator
from companion.estimation.fix_error import CODE_WANDER_S, MAST_M, fix_error

SETTING = Estimation()
ORIGIN = LatLon(50.0, -1.2)


def _fix(
    fix_type: int, stated_m: float | None, *, hdop: float = 0.9, speed_m_s: float | None = None
) -> GnssFix:
    return GnssFix(
        0.0,
        ORIGIN,
        fix_type,
        12,
        hdop,
        0.0,
        0.0,
        horizontal_accuracy_m=stated_m,
        speed_accuracy_m_s=speed_m_s,
    )


@pytest.mark.parametrize(
    ("fix_type", "stated_m", "sigma_m"),
    [
        (3, 2.5, 2.875), (3, 1.1, 1.265), (4, 0.6, 0.69), (4, 0.11, 0.1265), (3, None, 0.828),
        (3, 0.1, 0.0707), (3, 0.014, 0.0099), (5, 0.3, 0.2121), (6, 0.2, 0.1414),
    ],
)  # fmt: skip
def test_solutions_by_code_err_by_more_than_they_state_others_by_their_scatter(
    fix_type: int, stated_m: float | None, sigma_m: float
) -> None:
    estimator = Estimator()
    estimator.update(_fix(fix_type, stated_m), None, 0.0)
    assert estimator.position.sigma_m == pytest.approx(math.hypot(sigma_m, MAST_M), abs=1e-4)


def test_the_error_of_a_solution_by_code_lasts_for_minutes_that_of_others_as_configured() -> None:
    code, carrier = fix_error(_fix(4, 1.0), SETTING, 0.2), fix_error(_fix(5, 1.0), SETTING, 0.2)
    assert (code.wander_s, carrier.wander_s) == (CODE_WANDER_S, SETTING.wander_s)
    assert code.white_m2 / code.wander_m2 == pytest.approx(1.0 / 0.98**2 - 1.0)
    assert carrier.white_m2 / carrier.wander_m2 == pytest.approx(1.0 / 0.8**2 - 1.0)


@pytest.mark.parametrize(
    ("rate_hz", "density"), [(10.0, 20.02), (5.0, 10.03), (1.0, 2.164), (0.1, 1.0001), (1e9, 100.003)]
)
def test_noise_that_lasts_weighs_more_the_more_of_its_errors_are_the_same(
    rate_hz: float, density: float
) -> None:
    error = fix_error(_fix(3, 1.1), SETTING, 1.0 / rate_hz)
    assert error.density == pytest.approx(density, rel=1e-3)
    assert fix_error(_fix(5, 1.1), SETTING, 1.0 / rate_hz).density == 1.0


def test_the_first_fix_has_none_before_it() -> None:
    assert fix_error(_fix(3, 1.1), SETTING, math.inf).density == 1.0


@pytest.mark.parametrize(("stated_m_s", "sigma_m_s"), [(None, 0.05), (0.1, 0.05), (0.5, 0.1), (4.5, 0.9)])
def test_of_a_stated_speed_accuracy_a_fifth_counts(stated_m_s: float | None, sigma_m_s: float) -> None:
    error = fix_error(_fix(3, 1.1, speed_m_s=stated_m_s), SETTING, 0.2)
    assert error.velocity_m2_s2 == pytest.approx(sigma_m_s**2)
