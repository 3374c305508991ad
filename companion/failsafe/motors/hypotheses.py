"""What can be wrong with a motor, and what hull and battery would show of it.

A thrust of n |n| per motor (n: speed of the shaft, in shares) and a current from the pack of

    I = A d² − B d n − C d u        d: duty, u: speed through the water

follow from the motor's equation: armature current (d V − k ω) / R, drawn for the share d of the time, with a
shaft that the water also turns. A motor that is blocked draws A d², which is 2 to 3.3 times what it draws
turning: a loaded propeller lets a brushed motor reach half to 0.7 of its no-load speed.
"""

import math
from enum import IntEnum
from typing import Final, NamedTuple

from companion.core.evidence import MOST_SQUARE


class Fault(IntEnum):
    """Kinds that are told apart. Without a measured current, BLOCKED and FOULED cannot be told from DEAD, and
    LOST only with the speed of the shaft.
    """

    DEAD = 0  # no current, no thrust: a wire or the propeller is gone
    BLOCKED = 1  # stall current, no thrust
    FOULED = 2  # weed on the propeller: more current, less thrust
    REVERSED = 3  # thrust the wrong way for the usual current
    WEAK = 4  # a share of the voltage: worn brushes, a bad contact, a propeller that slips on its shaft
    LOST = 5  # the propeller: the motor turns without a load


class Hypothesis(NamedTuple):
    """One motor has one fault; the other is healthy.

    thrust: share of its thrust that is left, at the share `gain` of its command; thrust_spread: one standard
    deviation of the change, in shares of it. load: its current, in shares of the usual one; spread: one
    standard deviation of that share. spin, torque: what a controller that reports would say: shares of the
    usual speed, and of the current that is usual at this speed, each with one standard deviation.
    """

    is_left: bool
    fault: Fault
    thrust: float
    thrust_spread: float
    load: float
    spread: float
    spin: tuple[float, float]
    torque: tuple[float, float]
    gain: float = 1.0

    @property
    def has_thrust(self) -> bool:
        """Whether the motor still pushes, be it the wrong way."""
        return self.fault not in (Fault.DEAD, Fault.BLOCKED, Fault.LOST)

    def is_akin(self, other: "Hypothesis") -> bool:
        """Whether both are the same, or say that a motor has lost more or less of its thrust and current."""
        losses = {self.fault, other.fault} <= {Fault.DEAD, Fault.WEAK, Fault.LOST}
        return self == other or (losses and self.is_left is other.is_left)

    @property
    def text(self) -> str:
        """For the operator."""
        side = "left" if self.is_left else "right"
        if self.fault is Fault.FOULED:
            return f"Weed on the {side} propeller"
        if self.fault is Fault.LOST:
            return f"{side.capitalize()} propeller is lost"
        if self.fault is Fault.REVERSED:
            return f"Steering lost: {side} motor reversed"
        return f"{side.capitalize()} motor {_WORDS[self.fault]}"


_WORDS: Final = {Fault.DEAD: "gives no thrust", Fault.BLOCKED: "is blocked", Fault.WEAK: "is weak"}
# The currents of fouled, reversed and weak motors are worked out in `evidence`. A weak one has half of its
# voltage, 0.2 to 0.8: what a motor check calls weak (0.2 to 0.6 of the thrust) at rest and under way.
# What controllers report follows from the same equation: without a propeller a motor turns on its friction
# alone, the emulated catamaran's an eighth faster; one that stands draws what its controller allows; weed is
# a friction. The spreads were tuned on sample seed 907 of examples/campaigns/motors_telemetry.toml.
HYPOTHESES: Final = tuple(
    Hypothesis(is_left, *figures)
    for is_left in (True, False)
    for figures in (
        (Fault.DEAD, 0.0, 0.0, 0.0, 0.0, (0.0, 0.15), (0.0, 0.2)),
        (Fault.BLOCKED, 0.0, 0.0, 2.2, 0.35, (0.0, 0.05), (3.0, 1.0)),
        (Fault.FOULED, 0.4, 0.4, 1.0, 0.4, (0.75, 0.2), (2.0, 0.5)),
        (Fault.REVERSED, 1.0, 0.1, 1.0, 0.1, (1.0, 0.1), (1.0, 0.2), -1.0),
        (Fault.WEAK, 1.0, 0.15, 0.3, 0.1, (0.5, 0.15), (0.6, 0.2), 0.5),
        (Fault.LOST, 0.0, 0.0, 0.0, 0.0, (1.2, 0.15), (0.2, 0.15)),
    )
)


WEIGHT: Final = 0.5  # of a sample, whose error is like that of its neighbour
_MOST: Final = 2.0  # θ stays within two standard deviations: a fault of any size would explain anything


class EffectSize:
    """How large the effect of each hypothesis is: a factor θ, unknown, but the same for all measurements.

    Weed takes more or less of the thrust, a reversed propeller pulls more or less well. With an expected
    effect x of a hypothesis, a relative spread s of its size and θ, normal with variance 1 at first,

        residual = x (1 + s θ) + noise

    A scalar Kalman filter learns θ from the start of the supposed fault. Its innovations have the marginal
    likelihood of the hypothesis, so that an uncertain size costs evidence once, not at every measurement.
    """

    def __init__(self, hypotheses: int) -> None:
        self._theta, self._variance = [0.0] * hypotheses, [1.0] * hypotheses

    def forget(self, hypothesis: int) -> None:
        """The fault begins now at the earliest."""
        self._theta[hypothesis], self._variance[hypothesis] = 0.0, 1.0

    def cost(self, hypothesis: int, residual: float, effect: float, spread: float, variance: float) -> float:
        """Negative log likelihood of a residual, up to what all hypotheses have in common; learns θ.

        spread: one standard deviation of the effect, in the unit of the residual.
        """
        if not spread:  # a known size
            off = residual - effect
            return 0.5 * min(off * off / variance, MOST_SQUARE)
        known = self._variance[hypothesis] * spread
        wider = variance + known * spread
        innovation = residual - effect - spread * self._theta[hypothesis]
        gain = known / (variance / WEIGHT + known * spread)
        theta = self._theta[hypothesis] + gain * innovation
        self._theta[hypothesis] = min(max(theta, -_MOST), _MOST)
        self._variance[hypothesis] -= gain * known
        return 0.5 * min(innovation * innovation / wider + math.log(wider / variance), MOST_SQUARE)
