"""Estimates the delay of a sensor whose readings are stamped on arrival, by a bank of hypotheses.

A delay can only grow during a gap in the readings, so no longer ones than the gaps are considered. After a
gap, readings are compared with what thrust and steering predicted for each delay. Innovations give each
delay a likelihood; the evidence against the present one is a CUSUM (`companion.core.evidence`), so rates and
velocities tell delays apart only while the boat turns or changes speed (multiple-model estimation: Y.
Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001, section
11.6). An unknown constant offset, such as the current, is estimated for each.
"""

from collections import deque
from typing import Final

from companion.core.evidence import MOST_SQUARE, FaultEvidence
from companion.estimation.innovation import square

STEP_S: Final = 0.2  # at 2 m/s, 0.4 m: about a receiver's noise
DELAYS: Final = 16  # 0 to 3 s
PAUSE_S: Final = 0.4  # a shorter gap makes no delay that is told from the model's error
THRESHOLD: Final = 12.0  # nats: one false alarm in 160,000 samples, nine hours of turning
_WATCH_S: Final = 120.0  # after a gap: some turns
_OFFSET_S: Final = 8.0  # memory of the offset: longer than a turn
_SCALE: Final = 0.4  # standard deviation of the prediction's scale: thrust and hull as configured
_SLACK_S: Final = 1e-3


class DelayEstimator:
    """delay_s: subtract from the stamps. is_watching: readings may be late."""

    def __init__(self, sigma: float) -> None:
        """sigma: standard deviation of the prediction's error while the boat turns."""
        self.delay_s = 0.0
        self.evidence = FaultEvidence(DELAYS)  # for each delay, against the present one
        self._variance = sigma * sigma
        self._mean, self._swing = 0j, 0.0  # of the prediction: its mean and variance
        self._delay = self._count = 0
        self._expected = deque([0j] * 2 * DELAYS, maxlen=2 * DELAYS)  # latest first; readings have an age
        self._offsets = [0j] * DELAYS
        self._expected_s = self._compared_s = self._paused_s = self._gap_s = 0.0
        self._until_s = -1.0

    def is_watching(self, time_s: float) -> bool:
        """Whether readings may be late."""
        return time_s <= self._until_s or self._delay > 0

    def add_expected(self, time_s: float, value: complex) -> None:
        """Add the prediction of a reading at time_s, up to a constant. Call more often than STEP_S."""
        if time_s - self._expected_s >= STEP_S - _SLACK_S:
            self._expected_s = time_s
            self._expected.appendleft(value)

    def note_gap(self, time_s: float, pause_s: float) -> None:
        """A reading arrived after a gap of PAUSE_S or more. Gaps usual for the sensor are ignored."""
        is_usual = pause_s < 2.0 * self._gap_s
        self._gap_s = min(pause_s, DELAYS * STEP_S)
        if is_usual:
            return
        if time_s > self._until_s:
            self._paused_s, self._count = self.delay_s, 0
            self.evidence = FaultEvidence(DELAYS)
        self._paused_s += pause_s
        self._until_s = time_s + _WATCH_S

    def compare(self, time_s: float, value: complex) -> bool:
        """Process a reading with its stamp. Returns whether the delay has changed."""
        dt = time_s - self._compared_s
        if not self.is_watching(time_s) or dt < STEP_S - _SLACK_S:
            return False
        self._compared_s = time_s
        self._count += 1
        share = max(min(dt / _OFFSET_S, 1.0), 1.0 / self._count)
        behind = min(max(round((self._expected_s - time_s) / STEP_S), 0), DELAYS)
        expected, offsets, costs = self._expected, self._offsets, []
        swing = expected[behind + self._delay] - self._mean
        self._mean += share * swing
        self._swing += share * (square(swing) - self._swing)
        weight = 0.5 / (self._variance + _SCALE * _SCALE * self._swing)
        for delay in range(DELAYS):
            rest = value - expected[behind + delay] - offsets[delay]
            offsets[delay] += share * rest
            costs.append(min(weight * square(rest), 0.5 * MOST_SQUARE))
        return self.weigh(costs, dt)

    def weigh(self, costs: list[float], dt: float) -> bool:
        """Add the negative log likelihood of a reading by each delay. Whether the delay has changed."""
        evidence, now = self.evidence, costs[self._delay]
        for delay in range(DELAYS):
            # a delay of one step, or one step more or less, is within the model's error
            if delay * STEP_S <= self._paused_s + STEP_S and abs(delay - self._delay) > 1:
                evidence.add(delay, now - costs[delay], dt)
        best = evidence.against.index(max(evidence.against))
        if evidence.against[best] < THRESHOLD:
            return False
        self._delay = best if best > 1 else 0
        self.delay_s = self._delay * STEP_S
        self.evidence = FaultEvidence(DELAYS)
        return True
