"""How large the effect of each hypothesis is: a factor that is unknown, but the same for all measurements.

Weed takes more or less of the thrust, a reversed propeller pulls more or less well. With an expected effect
x of a hypothesis, a relative spread s of its size and an unknown θ, normal with variance 1 at first,

    residual = x (1 + s θ) + noise

A scalar Kalman filter learns θ from the start of the supposed fault. Its innovations have the marginal
likelihood of the hypothesis, so that an uncertain size costs evidence once, and not at every measurement.
"""

import math
from typing import Final

from companion.core.evidence import MOST_SQUARE

WEIGHT: Final = 0.5  # of a sample, whose error is like that of its neighbour
_MOST: Final = 2.0  # θ stays within two standard deviations: a fault of any size would explain anything


class EffectSize:
    """θ of each hypothesis, with its variance."""

    __slots__ = ("_theta", "_variance")

    def __init__(self, hypotheses: int) -> None:
        self._theta, self._variance = [0.0] * hypotheses, [1.0] * hypotheses

    def forget(self, hypothesis: int) -> None:
        """The fault begins now at the earliest."""
        self._theta[hypothesis], self._variance[hypothesis] = 0.0, 1.0

    def cost(self, hypothesis: int, residual: float, effect: float, spread: float, variance: float) -> float:
        """Negative log likelihood of a residual, up to what all hypotheses have in common; learns θ.

        spread: one standard deviation of the effect, in the unit of the residual.
        """
        known = self._variance[hypothesis] * spread
        wider = variance + known * spread
        innovation = residual - effect - spread * self._theta[hypothesis]
        gain = known / (variance / WEIGHT + known * spread)
        theta = self._theta[hypothesis] + gain * innovation
        self._theta[hypothesis] = min(max(theta, -_MOST), _MOST)
        self._variance[hypothesis] -= gain * known
        return 0.5 * min(innovation * innovation / wider + math.log(wider / variance), MOST_SQUARE)
