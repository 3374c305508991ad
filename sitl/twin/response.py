"""What a boat does, by its model: figures that a person can check afloat, in still water and air."""

from collections.abc import Mapping
from typing import Final

import numpy as np

from sitl.twin.fit import Fit, factors_of
from sitl.twin.model import LEFT, RIGHT, SegmentInputs, simulate
from sitl.twin.voyage import Floats
from sitl.world.pack import CELL_V
from sitl.world.scenario import Scenario

FIGURES: Final = ("top speed, m/s", "turn rate, °/s", "time to gather way, s", "time to turn, s")
"""Full ahead; left motor full ahead, from coasting at the speed of half throttle; until 63 % of that speed is
reached from rest, and 63 % of that turn rate."""
_STEP_S: Final = 0.05
_STEP: Final = 1e-3  # of a logarithm, for derivatives
_RUN_S, _TURN_S = 45.0, 15.0


def response(base: Scenario, factors: Mapping[str, Floats], pack_ohm: float) -> Floats:
    """FIGURES of boats with these factors on the base boat's values, shape (figures, boats). The pack is half
    full.
    """
    # Unlike motors would turn the boat, against which its program steers.
    drive, still, one = base.thrusters, np.zeros((1, 1)), np.ones((1, 1))
    gains = [drive.left_gain * factors.get(LEFT, one), drive.right_gain * factors.get(RIGHT, one)]
    equal = np.sqrt(gains[0] * gains[1])
    factors = {**factors, LEFT: equal / drive.left_gain, RIGHT: equal / drive.right_gain}
    steps, volts = round(_RUN_S / _STEP_S), base.battery.cells * CELL_V[len(CELL_V) // 2]
    ahead, none, open_v = np.tile([1.0, 0.5], (steps, 1)), np.zeros((steps, 2)), np.full((steps, 2), volts)
    inputs = SegmentInputs(_STEP_S, ahead, ahead, open_v, none, np.full(2, pack_ohm), none)
    speed = simulate(base, factors, inputs, still, still, still)[:, 0]
    full, none, open_v = (one[: round(_TURN_S / _STEP_S), :1] for one in (ahead, none, open_v))
    inputs = SegmentInputs(_STEP_S, full, none, open_v, none, np.full(1, pack_ohm))
    rate = simulate(base, factors, inputs, speed[-1, :, 1:], still, still)[:, 2, :, 0]
    return np.stack([speed[-1, :, 0], np.degrees(rate[-1]), _rise_s(speed[..., 1]), _rise_s(rate)])


def stated_figures(found: Fit) -> list[tuple[str, float, float]]:
    """FIGURES with their deviations, to first order."""
    logs = np.vstack([found.logs, found.logs + _STEP * np.eye(len(found.keys))])
    values = response(found.base, factors_of(found.keys, logs), found.segmented[0].voyage.pack_ohm)
    slopes = (values[:, 1:] - values[:, :1]) / _STEP
    deviations = np.sqrt(np.einsum("fi,ij,fj->f", slopes, found.covariance, slopes))
    return list(zip(FIGURES, values[:, 0].tolist(), deviations.tolist(), strict=True))


def _rise_s(run: Floats) -> Floats:
    """When each column first reaches 63 % of its last value."""
    share = run / ((1.0 - np.exp(-1.0)) * run[-1])
    after = np.maximum((share >= 1.0).argmax(axis=0), 1)
    column = np.arange(run.shape[1])
    low, high = share[after - 1, column], share[after, column]
    times_s: Floats = _STEP_S * (after - 1 + (1.0 - low) / (high - low))
    return times_s
