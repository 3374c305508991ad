"""One motion of the hull under thrust and an unknown force, and what each hypothesis changes of it.

    v' = −d v + k p + w        w' = −w / T + white noise

v is the speed ahead or the turn rate, p what the motors push that way, k its learned gain, and w what wind,
waves and drift add: a first-order Gauss-Markov process that decays with the time T (infinite: a random walk),
so that a steady force is absorbed within T. One that stays as large as what the motors give is evidence. A
Kalman filter makes white residuals of it (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with
Applications to Tracking and Navigation*, 2001, chapter 5). It is linear: had the motors pushed by dp less,
the residual would differ by the filter's response to dp alone, the failure signature of A. S. Willsky and H.
L. Jones (*A generalized likelihood ratio approach to the detection and estimation of jumps in linear
systems*, IEEE Trans. Automatic Control 21(1), 1976). So all hypotheses share one filter and one covariance.
"""

from collections.abc import Sequence
from typing import Final

# What the model gets wrong of a push, in shares of its effect: a fifth over a quarter of a second, since
# damping grows with the rate; and the delay of the thrust is known to 0.07 s. Without these, healthy motors
# of the catamaran reached 36 nats within half an hour, with them 12.
_PUSH_VAR_S: Final = 0.01
_DELAY_VAR_S2: Final = 0.005
_FIRST_VAR: Final = 0.1  # of the unknown force, before anything is known of it
_MOST_SQUARE: Final = 9.0  # a residual beyond three deviations does not widen the noise further
_LEAST_NOISE: Final = 0.2  # of the expected variance of residuals is always granted
_NOISE_S: Final = 30.0  # over which the noise is learned,
_GAIN_S: Final = 120.0  # and the gain
_LEAST_GAIN: Final = 0.4  # in shares of the configured gain
_MOST_GAIN: Final = 2.5


class MotionFilter:
    """residual is that of healthy motors, residuals those of the hypotheses, variance that of any of them.

    All are from the last `correct`. gain: k, learned.
    """

    def __init__(
        self,
        hypotheses: int,
        gain: float,
        prior: float,
        wander_per_s: float,
        sigma: float,
        correlation_s: float,
        decay_s: float,
    ) -> None:
        """prior: how many informative samples the configured gain is worth. wander_per_s: of w per √s. sigma:
        one standard deviation of a measurement. correlation_s: T. decay_s: d, in 1/s.
        """
        self.gain = self._gain_0 = gain
        self._prior = prior
        self._weighted, self._information = prior * gain, prior
        self._wander_var_s, self._measured_var = wander_per_s * wander_per_s, sigma * sigma
        self._correlation_s, self._decay_s = correlation_s, decay_s
        self._noise = 1.0  # share of the expected variance that residuals have
        self.residual, self.variance = 0.0, 1.0
        self.residuals = [0.0] * hypotheses
        self._responses = [[0.0, 0.0] for _ in range(hypotheses)]  # of value and wander, to a gain of 1
        self.restart()

    def restart(self) -> None:
        """Motors or hull did something that is not modelled. What was learned stays."""
        self._is_begun = False
        self._push = 0.0  # of the last step
        self._value = self._wander = 0.0  # of a filter that knows of no push,
        self._unit = [0.0, 0.0]  # and the response to the commanded push at a gain of 1
        self._p00, self._p01, self._p11 = self._measured_var, 0.0, _FIRST_VAR
        for at in range(len(self._responses)):
            self.forget(at)

    def forget(self, hypothesis: int) -> None:
        """The fault begins now at the earliest."""
        self._responses[hypothesis][0] = self._responses[hypothesis][1] = 0.0

    def predict(self, push: float, changes: Sequence[float], dt_s: float) -> None:
        """Go on by dt_s. changes: by how much each hypothesis changes the push."""
        if not self._is_begun:
            return
        keep = 1.0 - self._decay_s * dt_s
        kept = 1.0 - dt_s / self._correlation_s
        p01 = self._p01
        self._p00 = keep * keep * self._p00 + 2.0 * keep * dt_s * p01 + dt_s * dt_s * self._p11
        step, self._push = push - self._push, push
        doubt = _PUSH_VAR_S * dt_s * push * push + _DELAY_VAR_S2 * step * step
        self._p00 += self.gain * self.gain * doubt
        self._p01 = kept * (keep * p01 + dt_s * self._p11)
        self._p11 = kept * kept * self._p11 + self._wander_var_s * dt_s
        self._value = keep * self._value + dt_s * self._wander
        self._wander *= kept
        unit = self._unit
        unit[0] = keep * unit[0] + dt_s * (unit[1] + push)
        unit[1] *= kept
        for response, change in zip(self._responses, changes, strict=True):
            response[0] = keep * response[0] + dt_s * (response[1] + change)
            response[1] *= kept

    def correct(self, measured: float, dt_s: float, *, is_learning: bool) -> bool:
        """Take a measurement, dt_s after the last. False: it is the first, with nothing to compare it to."""
        if not self._is_begun:
            self._value, self._is_begun = measured, True
            return False
        expected = self._p00 + self._measured_var
        k0, k1 = self._p00 / expected, self._p01 / expected
        self._p11 -= k1 * self._p01
        self._p01 -= k0 * self._p01
        self._p00 -= k0 * self._p00
        raw, unit, gain = measured - self._value, self._unit[0], self.gain
        self._value += k0 * raw
        self._wander += k1 * raw
        self._unit[0] -= k0 * unit
        self._unit[1] -= k1 * unit
        self.residual = residual = raw - gain * unit
        self.variance = variance = expected * max(self._noise, _LEAST_NOISE)
        for at, response in enumerate(self._responses):
            change = response[0]
            self.residuals[at] = residual - gain * change
            response[0] -= k0 * change
            response[1] -= k1 * change
        if is_learning:
            square = min(residual * residual / expected, _MOST_SQUARE)
            self._noise += min(dt_s / _NOISE_S, 1.0) * (square - self._noise)
            self._learn(raw, unit, variance, dt_s)
        return True

    def _learn(self, raw: float, unit: float, variance: float, dt_s: float) -> None:
        """Least squares of the residuals without push over the response to it; old samples fade."""
        fading = min(dt_s / _GAIN_S, 1.0)
        self._weighted += fading * (self._prior * self._gain_0 - self._weighted) + raw * unit / variance
        self._information += fading * (self._prior - self._information) + unit * unit / variance
        gain = self._weighted / self._information
        self.gain = min(max(gain, _LEAST_GAIN * self._gain_0), _MOST_GAIN * self._gain_0)
