"""How late a sensor's readings are that are stamped as if they were fresh.

Readings that come in their order cannot become later without a pause: nobody looks for more lag than there
was silence. After one, what thrust and steering lead one to expect is compared with what is heard. A reading
that is late goes with what was expected a while ago: of all lags the right one is that which leaves the least
variance between the two, the time-delay estimate of least squares (G. C. Carter, *Coherence and Time Delay
Estimation*, Proc. IEEE 75(2), 1987). Constant differences do not count, and scale not much; on a straight
course at a steady speed all lags are alike, and nothing is said.
"""

from typing import Final

STEP_S: Final = 0.2
LAGS: Final = 16  # 0 to 3 s
_LENGTH: Final = 24  # of what is kept: readings on their way are older than the tick
PAUSE_S: Final = 0.4  # more than any sensor's usual
_UNUSUAL: Final = 1.8  # times what is usual
_PAUSES: Final = 0.3  # share of the latest one in that
_WATCH_S: Final = 120.0  # after a pause
_NEWS_S: Final = 20.0  # in which most lags are found
_MEMORY_S: Final = 8.0
_SCALE: Final = 2.0  # how far what is expected may be off by a factor, either way
_BETTER: Final = 0.35  # of the variance that the present lag leaves: what another one may leave at most,
_FOR_S: Final = 0.9  # for so long
_LEAST_STEPS: Final = 2  # less is the model's own fault
_SLACK_S: Final = 1e-3


class LatencyEstimator:
    """lag_s: what has to be taken off the stamps. until_s: as long as there is something to `compare`."""

    __slots__ = (
        "_alike", "_best", "_compared_s", "_count", "_expected", "_expected_s", "_heard_mean",
        "_heard_square", "_lag", "_least", "_means", "_next", "_odd_s", "_paused_s", "_squares", "_usual_s",
        "lag_s", "until_s",
    )  # fmt: skip

    def __init__(self, least: float) -> None:
        """least: a difference with no more than this deviation is the model's own fault."""
        self.lag_s = 0.0
        self._least = least * least
        self._lag = self._best = self._next = self._count = 0
        self._expected = [0j] * _LENGTH
        self._expected_s = self._compared_s = 0.0
        self.until_s = -1.0
        self._heard_mean, self._heard_square = 0j, 0.0
        self._means = [0j] * LAGS  # of what was expected so long before,
        self._squares = [0.0] * LAGS  # its variance,
        self._alike = [0.0] * LAGS  # and its covariance with what is heard
        self._odd_s = self._paused_s = self._usual_s = 0.0

    def is_uncertain(self, time_s: float) -> bool:
        """Whether readings may be late without its being known yet."""
        return self._odd_s > 0.0 or (self._lag == 0 and time_s < self.until_s + (_NEWS_S - _WATCH_S))

    def is_due(self, time_s: float) -> bool:
        """Whether `expect` is to be told something."""
        return time_s - self._expected_s >= STEP_S - _SLACK_S

    def add_expected(self, time_s: float, value: complex) -> None:
        """A reading of now would say this, but for a constant."""
        self._expected_s = time_s
        self._expected[self._next] = value
        self._next = self._next + 1 if self._next + 1 < _LENGTH else 0

    def note_gap(self, time_s: float, pause_s: float) -> None:
        """A reading has come after such a pause, of PAUSE_S or more. Some sensors do no better as a rule."""
        is_usual = pause_s < _UNUSUAL * self._usual_s
        self._usual_s += _PAUSES * (min(pause_s, LAGS * STEP_S) - self._usual_s)
        if is_usual:
            return
        if time_s > self.until_s:
            self._paused_s, self._count = self.lag_s, 0
        self._paused_s += pause_s
        self.until_s = time_s + _WATCH_S

    def compare(self, time_s: float, value: complex) -> bool:
        """Take a reading with its stamp; whether another lag is right from now on."""
        if time_s > self.until_s and self._lag == 0:
            return False
        dt = time_s - self._compared_s
        if dt < STEP_S - _SLACK_S:
            return False
        self._compared_s = time_s
        best, now, least = self._correlate(time_s, min(dt, 1.0) / _MEMORY_S, value)
        is_odd = now > self._least and least < _BETTER * now and abs(best - self._lag) >= _LEAST_STEPS
        self._odd_s = self._odd_s + dt if is_odd and abs(best - self._best) < _LEAST_STEPS else 0.0
        self._best = best
        if self._odd_s < _FOR_S:
            return False
        self._odd_s = 0.0
        self._lag = best if best >= _LEAST_STEPS else 0
        self.lag_s = self._lag * STEP_S
        return True

    def _correlate(self, time_s: float, share: float, value: complex) -> tuple[int, float, float]:
        """The best lag; the variance that the present one leaves, and the best one."""
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
            then = expected[back - lag]  # negative indices count from the ring's end
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
