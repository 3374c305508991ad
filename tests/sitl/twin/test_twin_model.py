import math
from itertools import pairwise

import numpy as np
import pytest
from twin_rig import OPEN_V, PACK_OHM, run_world

from sitl.scenarios.scenario import load_scenario
from sitl.twin.model import DISTURBANCES, LEFT, SegmentInputs, simulate

WIND = (3.0, -2.0)


@pytest.mark.parametrize("name", ["lake", "kit", "catamaran", "pool"])
def test_many_boats_at_once_move_as_the_emulators_own_hull_and_drive(name: str) -> None:
    random, steps = np.random.default_rng(5), 500
    commands = np.repeat(random.uniform(-1.0, 1.0, (steps // 50, 2)), 50, axis=0)
    commands[200:250] = 0.0
    plain = load_scenario("open", [f"boat.model={name}"])
    other = load_scenario(
        "open",
        [
            f"boat.model={name}",
            f"hull.sway_linear={1.3 * plain.hull.sway_linear}",
            f"hull.skeg_arm_m={0.7 * plain.hull.skeg_arm_m}",
            f"thrusters.propeller.astern_share={0.8 * plain.thrusters.propeller.astern_share}",
            "thrusters.left_gain=0.9",
        ],
    )
    factors = {
        "hull.sway_linear": np.array([[1.0], [1.3]]),
        "hull.skeg_arm_m": np.array([[1.0], [0.7]]),
        "thrusters.propeller.astern_share": np.array([[1.0], [0.8]]),
        LEFT: np.array([[1.0], [0.9]]),
    }
    both = commands[:, :, None] * [1.0, 0.5]  # the second segment sails at half of it
    truth = np.array(
        [[run_world(boat, share * commands, 0.02, WIND) for share in (1.0, 0.5)] for boat in (plain, other)]
    ).transpose(2, 3, 0, 1)
    open_v, ohm = np.full((steps, 2), OPEN_V), np.full(2, PACK_OHM)
    inputs = SegmentInputs(0.02, both[:, 0], both[:, 1], open_v, truth[:, 4], ohm)
    found = simulate(plain, factors, inputs, np.zeros(2), *(np.array([[one]]) for one in WIND))
    np.testing.assert_allclose(found, truth[:, :4], rtol=1e-9, atol=1e-12)


def test_what_is_left_of_gusts_that_a_helm_steers_against_is_white() -> None:
    step_s, random, boat = 0.05, np.random.default_rng(7), load_scenario("open")
    gusts, keep = np.zeros((6000, 2)), math.exp(-step_s / 4.0)
    for before, now in pairwise(gusts):
        now[:] = keep * before + 0.6 * math.sqrt(1.0 - keep * keep) * random.normal(size=2)
    ahead = np.full(gusts.shape, 0.5)
    truth = run_world(boat, ahead, step_s, gusts + WIND, lambda heading, rate: -0.8 * heading - 0.8 * rate)
    *_, heading, left, right = truth.T[..., None]
    rate = truth[:, 2:3] + random.normal(0.0, 0.002, heading.shape)
    inputs = SegmentInputs(
        step_s, left, right, np.full(left.shape, OPEN_V), heading, np.array([PACK_OHM]), rate
    )
    strength = np.array([[[1.0], [1e-6]], [[1.0], [1e-6]], [[0.05], [0.05]]]) * np.reshape(
        DISTURBANCES, (3, 1, 1)
    )
    north, east = (np.array([[one]]) for one in WIND)
    run = simulate(boat, {LEFT: np.ones((2, 1))}, inputs, np.zeros(1), north, east, strength)
    off = (run[:, 2, :, 0] - rate)[400::2]
    modelled, left_out = (one[1:] @ one[:-1] / (one @ one) for one in off.T)
    assert abs(modelled) < 0.35
    assert left_out > 0.9
    assert off[:, 0].std() < 0.004
