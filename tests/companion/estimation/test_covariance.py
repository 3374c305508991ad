"""The covariance against the textbook's matrices."""

import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.estimation.covariance import STATES, Covariance

(
    NORTH, EAST, HEADING, SURGE, SWAY, CURRENT_NORTH, CURRENT_EAST,
    RATE_BIAS, COMPASS_OFFSET, THRUST_GAIN, GNSS_NORTH, GNSS_EAST, GNSS_DELAY,
) = range(STATES)  # fmt: skip
DEVIATIONS = (3.0, 2.0, 0.4, 0.2, 0.3, 0.5, 0.4, 0.03, 0.035, 0.2, 0.25, 0.25, 0.03)


def compass() -> tuple[tuple[int, float], ...]:
    """What a compass measures."""
    return ((HEADING, 1.0), (COMPASS_OFFSET, 1.0))


def velocity(current: int, turn: float, ahead: float, aside: float) -> tuple[tuple[int, float], ...]:
    """What a component of the velocity over ground measures."""
    return ((HEADING, turn), (SURGE, ahead), (SWAY, aside), (current, 1.0))


def mixed(seed: int = 1) -> Covariance:
    """A covariance with all kinds of correlations."""
    rng, covariance = random.Random(seed), Covariance(DEVIATIONS)
    for _ in range(5):
        for position, current in ((NORTH, CURRENT_NORTH), (EAST, CURRENT_EAST)):
            shares = [rng.uniform(-2.0, 2.0) for _ in range(3)]
            covariance.mix(
                position,
                ((position, 1.0), *zip((HEADING, SURGE, SWAY), shares, strict=True), (current, 0.2)),
            )
        covariance.mix(HEADING, ((HEADING, 1.0), (RATE_BIAS, -0.2)))
        covariance.mix(SURGE, ((SURGE, 0.9), (THRUST_GAIN, 0.3)))
        covariance.mix(SWAY, ((SWAY, 0.8),))
        covariance.measure(compass(), rng.gauss(0.0, 0.1), 1e-4)
        covariance.commit()
        for state in range(STATES):
            covariance.add(state, 0.001)
    return covariance


@pytest.mark.parametrize(
    ("state", "shares"),
    [
        (NORTH, ((NORTH, 1.0), (HEADING, -0.3), (SURGE, 0.15), (SWAY, 0.1), (CURRENT_NORTH, 0.2))),
        (SURGE, ((SURGE, 0.7), (SWAY, 0.4))),
    ],
)
def test_a_step_is_the_product_of_matrices(state: int, shares: tuple[tuple[int, float], ...]) -> None:
    covariance = mixed()
    before, transition = np.array(covariance.rows), np.eye(STATES)
    transition[state] = 0.0
    for other, share in shares:
        transition[state, other] = share
    covariance.mix(state, shares)
    assert np.array(covariance.rows) == pytest.approx(transition @ before @ transition.T, abs=1e-12)


def test_measurements_of_one_moment_give_what_the_matrix_form_gives() -> None:
    covariance, rng = mixed(), random.Random(4)
    before = np.array(covariance.rows)
    jacobian = np.zeros((3, STATES))
    jacobian[0, [HEADING, COMPASS_OFFSET]] = 1.0
    jacobian[1, [HEADING, SURGE, SWAY, CURRENT_NORTH]] = (-1.2, 0.8, -0.6, 1.0)
    jacobian[2, [NORTH, GNSS_NORTH, GNSS_DELAY]] = (1.0, 1.0, -1.5)
    noise = np.diag([1e-3, 0.01, 0.04])
    innovation = np.array([rng.gauss(0.0, 0.2) for _ in range(3)])
    variances = [
        covariance.measure(shares, value, white)[1]
        for shares, value, white in (
            (compass(), innovation[0], 1e-3),
            (velocity(CURRENT_NORTH, -1.2, 0.8, -0.6), innovation[1], 0.01),
            (((NORTH, 1.0), (GNSS_NORTH, 1.0), (GNSS_DELAY, -1.5)), innovation[2], 0.04),
        )
    ]
    step = covariance.commit()
    total = jacobian @ before @ jacobian.T + noise
    gain = before @ jacobian.T @ np.linalg.inv(total)
    assert step == pytest.approx(gain @ innovation, abs=1e-9)
    assert np.array(covariance.rows) == pytest.approx(before - gain @ jacobian @ before, abs=1e-9)
    assert np.prod(variances) == pytest.approx(np.linalg.det(total), rel=1e-9)


def test_what_was_withdrawn_changes_nothing() -> None:
    covariance = mixed()
    before = covariance.rows
    covariance.measure(velocity(CURRENT_NORTH, 1.0, 1.0, 1.0), 5.0, 0.01)
    covariance.withdraw(1)
    assert covariance.commit() == [0.0] * STATES
    assert covariance.rows == before
    covariance.measure(compass(), 0.1, 1e-3)
    covariance.measure(velocity(CURRENT_NORTH, 1.0, 1.0, 1.0), 5.0, 0.01)
    covariance.withdraw(1)
    after = mixed()
    after.measure(compass(), 0.1, 1e-3)
    assert covariance.commit() == after.commit()


@given(st.integers(0, 10_000), st.lists(st.floats(1e-6, 10.0), min_size=1, max_size=20))
def test_it_stays_symmetric_and_positive(seed: int, noises: list[float]) -> None:
    covariance, rng = mixed(seed), random.Random(seed)
    for noise in noises:
        covariance.measure(velocity(CURRENT_EAST, rng.uniform(-2.0, 2.0), 0.6, -0.8), 0.1, noise)
        covariance.commit()
    rows = np.array(covariance.rows)
    assert np.array_equal(rows, rows.T) or rows == pytest.approx(rows.T, rel=1e-12)
    assert min(np.linalg.eigvalsh(0.5 * (rows + rows.T))) > -1e-9


@pytest.mark.parametrize("states", [(NORTH,), (NORTH, EAST)])
def test_no_measurement_is_so_good_that_nothing_is_left_to_be_learned(states: tuple[int, ...]) -> None:
    covariance = Covariance(DEVIATIONS)
    for state in states:
        covariance.measure(((state, 1.0),), 0.1, 0.0)
    covariance.commit()
    assert all(0.0 < covariance.variance(state) < 1e-9 for state in states)
    for state in states:  # the next one divides by what is left
        _, variance = covariance.measure(((state, 1.0),), 0.1, 0.0)
        assert variance > 0.0
