"""A voyage cut into segments, and what a model's run through them would have shown the boat's sensors."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from sitl.twin.model import SegmentInputs
from sitl.twin.voyage import STORED_S, Floats, Voyage, hat_functions
from sitl.world.scenario import Scenario

Indices = NDArray[np.int64]

CHANNELS: Final = ("ahead, m/s", "abeam, m/s", "turn rate, rad/s", "current, A")
SEGMENT_S: Final = 30.0
RUN_IN_S: Final = 4.0  # in which sway, turn rate and motors forget their beginning; the speed's is fitted
_CURRENT_S: Final = 200.0  # between knots of the current
# What is known beforehand of a voyage's nuisances, one deviation: wind relative to the water, north and east;
# logarithms of disturbances over DISTURBANCES; the fixes' delay beyond the assumed one; the compass's
# constant error; the current with the motors stopped
NUISANCE: Final = (3.0, 3.0, 1.0, 1.0, 1.0, 0.1, 0.05, 0.3)
OF_RUN: Final = 5
"""The first of them change the run, the rest what is seen of it."""
CURRENT_M_S, _DRIFT_M_S = 1.0, 0.05  # of the current, and of its change from knot to knot


class SegmentedVoyage:
    """A voyage cut into segments, and what was measured in them."""

    def __init__(self, voyage: Voyage, base: Scenario, segment_s: float = SEGMENT_S) -> None:
        self.voyage, self._base, self._end_s = voyage, base, RUN_IN_S + segment_s
        run_in, length = round(RUN_IN_S / voyage.step_s), round(segment_s / voyage.step_s)
        self.count = max(1, (len(voyage.left) - run_in) // length)
        starts = np.arange(self.count) * length
        rows = np.minimum(starts + np.arange(run_in + length + 50)[:, None], len(voyage.left) - 1)
        self.inputs = SegmentInputs(
            voyage.step_s, voyage.left[rows], voyage.right[rows], voyage.open_v[rows],
            voyage.heading_rad[rows], np.full(self.count, voyage.pack_ohm), voyage.rate_rad_s[rows],
        )  # fmt: skip
        self._begins_s = voyage.start_s + starts * voyage.step_s
        self.fixes = voyage.fixes[self._segment(voyage.fixes[:, 0]) >= 0]
        pack = voyage.pack[np.isfinite(voyage.pack[:, 2])]
        self._pack = pack[self._segment(pack[:, 0]) >= 0]
        self.rated = slice(run_in, run_in + length, round(STORED_S / voyage.step_s))
        rates = voyage.rate_rad_s[rows[self.rated]].T
        self.cos, self.sin = self._facing(0.0, 0.0)
        north, east = self.fixes[:, 1], self.fixes[:, 2]
        ahead, abeam = north * self.cos + east * self.sin, east * self.cos - north * self.sin
        self.measured: tuple[Floats, ...] = (ahead, abeam, rates.ravel(), self._pack[:, 2])
        self.surge_m_s = np.interp(self._begins_s, self.fixes[:, 0], ahead)
        self.segment = (
            *[self._segment(self.fixes[:, 0])] * 2, np.repeat(np.arange(self.count), rates.shape[1]),
            self._segment(self._pack[:, 0]),
        )  # fmt: skip
        rated_s = voyage.step_s * np.arange(run_in, run_in + length, self.rated.step)
        rated_s = np.add.outer(self._begins_s, rated_s).ravel()
        self.times_s: tuple[Floats, ...] = (self.fixes[:, 0], self.fixes[:, 0], rated_s, self._pack[:, 0])
        knots = hat_functions(self.fixes[:, 0], _CURRENT_S)
        # The first knot's current, and each change from knot to knot
        scale = np.full(knots.shape[1], _DRIFT_M_S)
        scale[0] = CURRENT_M_S
        self._flow = knots @ np.tril(np.ones((len(scale), len(scale)))) * scale
        self.nuisances = len(NUISANCE) + 2 * len(scale)

    def _segment(self, times_s: Floats) -> Indices:
        """The segment in which a time is compared, −1 without one."""
        at = np.searchsorted(self._begins_s + RUN_IN_S, times_s, side="right") - 1
        return np.where(times_s < self._begins_s[-1] + self._end_s, at, -1)

    def _facing(self, late_s: float, off_rad: float) -> tuple[Floats, Floats]:
        voyage = self.voyage
        steps = (self.fixes[:, 0] - late_s - voyage.start_s) / voyage.step_s
        heading_rad = np.interp(steps, np.arange(len(voyage.left)), voyage.heading_rad) - off_rad
        return np.cos(heading_rad), np.sin(heading_rad)

    def flow_m_s(self, nuisance: Floats) -> tuple[Floats, Floats]:
        """The current over ground at each fix, north and east."""
        north, east = nuisance[len(NUISANCE) :].reshape(2, -1)
        return self._flow @ north, self._flow @ east

    def predicted(self, run: Floats, nuisance: Floats) -> tuple[Floats, ...]:
        """What would have been measured, by channel. run: the model's output, shape (steps, 4, segments)."""
        late_s, off_rad, idle_a = nuisance[OF_RUN : len(NUISANCE)] * NUISANCE[OF_RUN:]
        cos, sin = self._facing(late_s, off_rad)
        flow_n, flow_e = self.flow_m_s(nuisance)
        at_s, segment = self.fixes[:, 0] - late_s, self.segment[0]
        surge, sway = (self._at(run[:, n], at_s, segment) for n in (0, 1))
        north, east = surge * cos - sway * sin + flow_n, surge * sin + sway * cos + flow_e
        return (
            north * self.cos + east * self.sin,
            east * self.cos - north * self.sin,
            run[self.rated, 2].T.ravel(),
            self._at(run[:, 3], self._pack[:, 0], self.segment[3]) + self._base.battery.idle_a + idle_a,
        )

    def _at(self, run: Floats, times_s: Floats, segment: Indices) -> Floats:
        """An output, shape (steps, segments), at these times in these segments."""
        at = np.clip((times_s - self._begins_s[segment]) / self.voyage.step_s, 0.0, len(run) - 1.001)
        below = at.astype(np.int64)
        share = at - below
        value: Floats = run[below, segment] * (1.0 - share) + run[below + 1, segment] * share
        return value
