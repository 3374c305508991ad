"""An effect of unknown size: what it costs, and how far it may be from what is expected."""

from random import Random

import pytest

from companion.core.evidence import MOST_SQUARE
from companion.failsafe.motors.hypotheses import WEIGHT, EffectSize


def test_the_size_is_learned_from_what_is_measured() -> None:
    """Residuals half as large again as expected cost no more than the noise, once that is known."""
    size, random = EffectSize(1), Random(1)
    costs = [size.cost(0, 1.5 + random.gauss(0.0, 0.2), 1.0, 0.4, 0.04) for _ in range(2000)]
    assert sum(costs[100:]) / 1900 == pytest.approx(0.5, rel=0.1)
    assert size._theta[0] == pytest.approx(1.25, rel=0.03)
    assert size._variance[0] == pytest.approx(0.04 / WEIGHT / (2000 * 0.4**2), rel=0.1)


@pytest.mark.parametrize("residual", [-5.0, 5.0])
def test_a_size_beyond_two_deviations_is_not_believed(residual: float) -> None:
    size = EffectSize(1)
    costs = [size.cost(0, residual, 1.0, 0.4, 0.04) for _ in range(500)]
    assert abs(size._theta[0]) == 2.0
    assert costs[-1] == 0.5 * MOST_SQUARE


def test_each_hypothesis_learns_for_itself_until_it_forgets() -> None:
    size = EffectSize(2)
    first = [size.cost(at, 1.3, 1.0, 0.4, 0.04) for at in (0, 1)]
    size.cost(0, 1.3, 1.0, 0.4, 0.04)
    size.forget(0)
    assert first[0] == first[1] == size.cost(0, 1.3, 1.0, 0.4, 0.04)
    assert size.cost(1, 1.3, 1.0, 0.4, 0.04) < first[1]


def test_two_neighbouring_samples_count_for_one() -> None:
    """Their errors are alike: together they teach what one of an error of its own would."""
    size, spread, variance = EffectSize(1), 0.4, 0.04
    for _ in range(2):
        size.cost(0, 1.0, 1.0, spread, variance)
    assert 1.0 / size._variance[0] == pytest.approx(1.0 + spread**2 / variance)
