"""Estimates the latency of a sensor whose readings are stamped on arrival.

Latency can only grow during a gap in the readings, so the search covers no more than the gaps. After a gap,
readings are correlated with their prediction from thrust and steering: the latency is the lag with the least
residual variance, the least-squares time-delay estimate (G. C. Carter, *Coherence and Time Delay Estimation*,
Proc. IEEE 75(2), 1987). Constant offsets cancel and scale has little effect. On a straight course at constant
speed all lags fit equally well, and no estimate is made.
"""

from typing import Final

STEP_S: Final = 0.2
LAGS: Final = 16  # 0 to 3 s
_LENGTH: Final = 24  # of the history: readings may be older than the tick
PAUSE_S: Final = 0.4  # more than the usual period of any sensor
_UNUSUAL: Final = 1.8  # times the usual gap
_PAUSES: Final = 0.3  # weight of the latest gap in the mean
_WATCH_S: Final = 120.0  # after a gap
_NEWS_S: Final = 20.0  # within which most latencies are found
_MEMORY_S: Final = 8.0
_SCALE: Final = 2.0  # largest scale error of the prediction, either way
_BETTER: Final = 0.35  # a better lag must leave at most this share of the present one's variance,
_FOR_S: Final = 0.9  # for this long
_LEAST_STEPS: Final = 2  # a smaller latency is within the model error
_SLACK_S: Final = 1e-3


class LatencyEstimator:
    """lag_s: subtract from the stamps. until_s: end of the period in which `compare` is needed."""

    def __init__(self, least: float) -> None:
        """least: residuals with a smaller deviation are within the model error."""
        self.lag_s = 0.0
        self._least = least * least
        self._lag = self._best = self._next = self._count = 0
        self._expected = [0j] * _LENGTH
        self._expected_s = self._compared_s = 0.0
        self.until_s = -1.0
        self._heard_mean, self._heard_square = 0j, 0.0
        self._means = [0j] * LAGS  # of the predictions at each lag,
        self._squares = [0.0] * LAGS  # their variance,
        self._alike = [0.0] * LAGS  # and their covariance with the readings
        self._mismatch_s = self._paused_s = self._usual_s = 0.0

    def is_uncertain(self, time_s: float) -> bool:
        """Whether readings may be late without a known latency."""
        return self._mismatch_s > 0.0 or (self._lag == 0 and time_s < self.until_s + (_NEWS_S - _WATCH_S))

    def is_due(self, time_s: float) -> bool:
        """Whether `add_expected` is due."""
        return time_s - self._expected_s >= STEP_S - _SLACK_S

    def add_expected(self, time_s: float, value: complex) -> None:
        """Add the prediction of a reading at time_s, up to a constant."""
        self._expected_s = time_s
        self._expected[self._next] = value
        self._next = self._next + 1 if self._next + 1 < _LENGTH else 0

    def note_gap(self, time_s: float, pause_s: float) -> None:
        """A reading arrived after a gap of PAUSE_S or more. Gaps usual for the sensor are ignored."""
        is_usual = pause_s < _UNUSUAL * self._usual_s
        self._usual_s += _PAUSES * (min(pause_s, LAGS * STEP_S) - self._usual_s)
        if is_usual:
            return
        if time_s > self.until_s:
            self._paused_s, self._count = self.lag_s, 0
        self._paused_s += pause_s
        self.until_s = time_s + _WATCH_S

    def compare(self, time_s: float, value: complex) -> bool:
        """Process a reading with its stamp. Returns whether the latency has changed."""
        if time_s > self.until_s and self._lag == 0:
            return False
        dt = time_s - self._compared_s
        if dt < STEP_S - _SLACK_S:
            return False
        self._compared_s = time_s
        best, now, least = self._correlate(time_s, min(dt, 1.0) / _MEMORY_S, value)
        is_mismatch = now > self._least and least < _BETTER * now and abs(best - self._lag) >= _LEAST_STEPS
        self._mismatch_s = (
            self._mismatch_s + dt if is_mismatch and abs(best - self._best) < _LEAST_STEPS else 0.0
        )
        self._best = best
        if self._mismatch_s < _FOR_S:
            return False
        self._mismatch_s = 0.0
        self._lag = best if best >= _LEAST_STEPS else 0
        self.lag_s = self._lag * STEP_S
        return True

    def _correlate(self, time_s: float, share: float, value: complex) -> tuple[int, float, float]:
        """The best lag, the residual variance of the present lag, and that of the best."""
        self._count += 1
        share = max(share, 1.0 / self._count)
        behind = round((self._expected_s - time_s) / STEP_S)
        back = self._next - 1 - min(max(behind, 0), _LENGTH - LAGS)
        means, squares, alike, expected = self._means, self._squares, self._alike, self._expected
        self._heard_mean += share * (value - self._heard_mean)
        value -= self._heard_mean
        heard = self._heard_square
        heard += share * (value.real * value.real + value.imag * value.imag - heard)
        self._heard_square = heard
        most_s = self._paused_s + STEP_S
        best, least, now = 0, 1e9, 0.0
        for lag in range(LAGS):
            then = expected[back - lag]  # negative indices wrap around the ring
            mean = means[lag] + share * (then - means[lag])
            then -= mean
            means[lag] = mean
            square = squares[lag] + share * (then.real * then.real + then.imag * then.imag - squares[lag])
            squares[lag] = square
            like = alike[lag] + share * (then.real * value.real + then.imag * value.imag - alike[lag])
            alike[lag] = like
            scale = min(max(like / square if square > 0.0 else 1.0, 1.0 / _SCALE), _SCALE)
            left = heard - 2.0 * scale * like + scale * scale * square
            if left < least and lag * STEP_S <= most_s:
                best, least = lag, left
            if lag == self._lag:
                now = left
        return best, now, least
