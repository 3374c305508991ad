"""Evidence for faults against health: one CUSUM for each hypothesis.

The sum of the log likelihood ratios of a hypothesis against health, never below zero, is E. S. Page's CUSUM
(*Continuous inspection schemes*, Biometrika 41, 1954; M. Basseville, I. V. Nikiforov, *Detection of Abrupt
Changes*, 1993, chapter 2): it stays near zero while all is well and climbs from the moment of the fault. With
a threshold of h nats the mean time between false alarms is at least exp(h) independent samples (G. Lorden,
*Procedures for reacting to a change in distribution*, Annals of Mathematical Statistics 42, 1971). Two rules
allow for wrong models: no sample counts for more than MOST_SQUARE, and evidence fades by FADE_S.
"""

import math
from collections.abc import Sequence
from typing import Final

MOST_SQUARE: Final = 25.0  # five standard deviations: no hypothesis explains a larger residual
FADE_S: Final = 0.5  # nats/s, so that a short disturbance proves nothing; chosen by the motors' campaigns
LEARNING: Final = 5.0  # with more evidence than this against what is learned from, nothing is learned


class FaultEvidence:
    """`against` has the evidence for each hypothesis, in nats; it stays the same list."""

    __slots__ = ("against",)

    def __init__(self, count: int) -> None:
        self.against = [0.0] * count

    def add(self, at: int, gain: float, dt_s: float) -> bool:
        """Add a log likelihood ratio over dt_s. False if nothing is left: the fault has not begun."""
        self.against[at] = total = max(self.against[at] + (gain - FADE_S * dt_s), 0.0)
        return total > 0.0

    def probabilities(self, thresholds: Sequence[float]) -> list[float]:
        """Probability of each hypothesis, if its threshold is the prior odds against it, in nats."""
        odds = [math.exp(min(have - at, 50.0)) for have, at in zip(self.against, thresholds, strict=True)]
        total = 1.0 + sum(odds)
        return [one / total for one in odds]
