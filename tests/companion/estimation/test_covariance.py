"""The covariance against the textbook's matrices, and its kernel against its twin."""

import importlib
import random
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.estimation import covariance as twin
from companion.estimation.covariance import (
    COMPASS_OFFSET,
    CURRENT_EAST,
    CURRENT_NORTH,
    GNSS_DELAY,
    GNSS_NORTH,
    HEADING,
    NORTH,
    RATE_BIAS,
    STATES,
    SURGE,
    SWAY,
)  # fmt: skip

DEVIATIONS = (3.0, 2.0, 0.4, 0.2, 0.3, 0.5, 0.4, 0.03, 0.035, 0.2, 0.25, 0.25, 0.03)


def kernel() -> Any:  # noqa: ANN401
    """The compiled module; skips where it was not built."""
    return pytest.importorskip("companion.estimation._covariance")


def mixed(module: Any, seed: int = 1) -> Any:  # noqa: ANN401
    """A covariance with all kinds of correlations."""
    rng, covariance = random.Random(seed), module.Covariance(DEVIATIONS)
    for _ in range(5):
        for position, current in ((0, CURRENT_NORTH), (1, CURRENT_EAST)):
            covariance.carry(position, *[rng.uniform(-2.0, 2.0) for _ in range(3)], current, 0.2)
        covariance.combine(HEADING, 1.0, RATE_BIAS, -0.2)
        covariance.combine(SURGE, 0.9, 9, 0.3)
        covariance.scale(SWAY, 0.8)
        covariance.tell_heading(rng.gauss(0.0, 0.1), 1e-4)
        covariance.accept(1)
        covariance.commit()
        for state in range(STATES):
            covariance.add(state, 0.001)
    return covariance


def measured(covariance: Any, rng: random.Random) -> list[Any]:  # noqa: ANN401
    """All innovations, variances and the correction of one compass reading and one fix."""
    told = [covariance.tell_heading(rng.gauss(0.0, 0.1), 1e-3)]
    covariance.accept(1)
    for slot, current in enumerate((CURRENT_NORTH, CURRENT_EAST)):
        shares = [rng.uniform(-1.0, 1.0) for _ in range(3)]
        told.append(covariance.tell_velocity(slot, *shares, current, rng.gauss(0.0, 0.1), 0.01))
    covariance.accept(2)
    for slot, current in enumerate((CURRENT_NORTH, CURRENT_EAST)):
        shares = [rng.uniform(-1.0, 1.0) for _ in range(3)]
        told.append(covariance.tell_position(slot, -0.2, 1.5, *shares, current, rng.gauss(0.0, 0.3), 0.04))
    covariance.accept(2)
    return [told, covariance.commit(), covariance.rows]


def test_kernel_and_twin_return_the_same_results() -> None:
    compiled, plain = mixed(kernel()), mixed(twin)
    assert compiled.rows == plain.rows
    assert measured(compiled, random.Random(3)) == measured(plain, random.Random(3))


def test_a_step_of_the_position_is_the_product_of_matrices() -> None:
    covariance = mixed(twin)
    before, transition = np.array(covariance.rows), np.eye(STATES)
    transition[NORTH, [HEADING, SURGE, SWAY, CURRENT_NORTH]] = (-0.3, 0.15, 0.1, 0.2)
    covariance.carry(NORTH, -0.3, 0.15, 0.1, CURRENT_NORTH, 0.2)
    assert np.array(covariance.rows) == pytest.approx(transition @ before @ transition.T, abs=1e-12)


def test_a_state_that_is_scaled_mixed_or_forgotten_is_so_in_row_and_column() -> None:
    covariance = mixed(twin)
    before, transition = np.array(covariance.rows), np.eye(STATES)
    transition[SURGE, SURGE], transition[SURGE, SWAY] = 0.7, 0.4
    covariance.combine(SURGE, 0.7, SWAY, 0.4)
    assert np.array(covariance.rows) == pytest.approx(transition @ before @ transition.T, abs=1e-12)
    covariance.reset(SURGE, 4.0)
    assert covariance.rows[SURGE] == [0.0] * SURGE + [4.0] + [0.0] * (STATES - SURGE - 1)
    assert [row[SURGE] for row in covariance.rows] == covariance.rows[SURGE]
    covariance.raise_to(SURGE, 3.0)
    assert covariance.variance(SURGE) == 4.0
    covariance.raise_to(SURGE, 5.0)
    assert covariance.variance(SURGE) == 5.0


def test_measurements_of_one_moment_give_what_the_matrix_form_gives() -> None:
    covariance, rng = mixed(twin), random.Random(4)
    before = np.array(covariance.rows)
    jacobian = np.zeros((3, STATES))
    jacobian[0, [HEADING, COMPASS_OFFSET]] = 1.0
    jacobian[1, [HEADING, SURGE, SWAY, CURRENT_NORTH]] = (-1.2, 0.8, -0.6, 1.0)
    jacobian[2, [NORTH, GNSS_NORTH, GNSS_DELAY]] = (1.0, 1.0, -1.5)
    jacobian[2, [HEADING, SURGE, SWAY, CURRENT_NORTH]] = (0.24, -0.16, 0.12, -0.2)
    noise = np.diag([1e-3, 0.01, 0.04])
    innovation = np.array([rng.gauss(0.0, 0.2) for _ in range(3)])
    variances = [covariance.tell_heading(innovation[0], 1e-3)[1]]
    covariance.accept(1)
    variances.append(covariance.tell_velocity(0, -1.2, 0.8, -0.6, CURRENT_NORTH, innovation[1], 0.01)[1])
    variances.append(
        covariance.tell_position(1, -0.2, 1.5, -1.2, 0.8, -0.6, CURRENT_NORTH, innovation[2], 0.04)[1]
    )
    covariance.accept(2)
    step = covariance.commit()
    total = jacobian @ before @ jacobian.T + noise
    gain = before @ jacobian.T @ np.linalg.inv(total)
    assert step == pytest.approx(gain @ innovation, abs=1e-9)
    assert np.array(covariance.rows) == pytest.approx(before - gain @ jacobian @ before, abs=1e-9)
    assert np.prod(variances) == pytest.approx(np.linalg.det(total), rel=1e-9)


def test_what_was_not_accepted_changes_nothing() -> None:
    covariance = mixed(twin)
    before = covariance.rows
    covariance.tell_velocity(0, 1.0, 1.0, 1.0, CURRENT_NORTH, 5.0, 0.01)
    assert covariance.commit() == [0.0] * STATES
    assert covariance.rows == before


@given(st.integers(0, 10_000), st.lists(st.floats(1e-6, 10.0), min_size=1, max_size=20))
def test_it_stays_symmetric_and_positive(seed: int, noises: list[float]) -> None:
    covariance, rng = mixed(twin, seed), random.Random(seed)
    for noise in noises:
        covariance.tell_velocity(0, rng.uniform(-2.0, 2.0), 0.6, -0.8, CURRENT_EAST, 0.1, noise)
        covariance.accept(1)
        covariance.commit()
    rows = np.array(covariance.rows)
    assert np.array_equal(rows, rows.T) or rows == pytest.approx(rows.T, rel=1e-12)
    assert min(np.linalg.eigvalsh(0.5 * (rows + rows.T))) > -1e-9


def test_the_kernel_refuses_more_measurements_than_it_has_room_for() -> None:
    covariance = kernel().Covariance(DEVIATIONS)
    for _ in range(7):
        covariance.tell_heading(0.0, 1.0)
        covariance.accept(1)
    with pytest.raises(IndexError):
        covariance.tell_heading(0.0, 1.0)


def test_the_twin_has_the_states_of_the_filter_in_order() -> None:
    module = importlib.import_module("companion.estimation.report")
    assert len(module.STATE_NAMES) == STATES
    assert module.STATE_NAMES[GNSS_DELAY] == "delay_s"
    assert module.STATE_NAMES[COMPASS_OFFSET] == "offset_rad"
