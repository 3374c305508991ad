"""The CUSUM against theory: how late a change is noticed, and how seldom one is invented."""

import math
import random

import pytest

from companion.core.evidence import FADE_S, FaultEvidence

SHIFT = 1.0  # of the mean after the fault, in standard deviations
SAMPLE_S = 1e-3  # so short that nothing fades


def ratio(sample: float) -> float:
    """Log likelihood ratio of a mean of SHIFT against 0."""
    return SHIFT * sample - 0.5 * SHIFT * SHIFT


def samples_until(threshold: float, mean: float, seed: int, most: int = 100_000) -> int:
    evidence, rng = FaultEvidence(1), random.Random(seed)
    for sample in range(1, most):
        evidence.add(0, ratio(rng.gauss(mean, 1.0)), SAMPLE_S)
        if evidence.against[0] > threshold:
            return sample
    return most


@pytest.mark.parametrize("threshold", [6.0, 12.0])
def test_a_fault_is_proved_after_the_threshold_over_the_information_of_a_sample(threshold: float) -> None:
    delays = [samples_until(threshold, SHIFT, seed) for seed in range(100)]
    # Wald: h / D samples with D = SHIFT²/2 nats, and the overshoot of the last one
    expected = threshold / (0.5 * SHIFT * SHIFT)
    assert sum(delays) / len(delays) == pytest.approx(expected + 1.2, rel=0.12)


def test_without_a_fault_the_mean_time_to_an_alarm_is_at_least_lordens_bound() -> None:
    runs = [samples_until(5.0, 0.0, seed) for seed in range(60)]
    assert sum(runs) / len(runs) > math.exp(5.0)


def test_evidence_is_never_negative_and_says_when_nothing_is_left() -> None:
    evidence = FaultEvidence(2)
    assert not evidence.add(0, -3.0, 0.1)
    assert evidence.add(1, 3.0, 0.1)
    assert evidence.against == [0.0, pytest.approx(3.0 - 0.1 * FADE_S)]


def test_the_threshold_is_the_prior_odds_against_a_fault() -> None:
    evidence = FaultEvidence(2)
    assert max(evidence.probabilities((6.0, 12.0))) < 0.003
    evidence.against = [6.0, 0.0]
    first, second = evidence.probabilities((6.0, 12.0))
    assert first == pytest.approx(0.5, abs=1e-3)
    assert second < 1e-5
    evidence.against = [500.0, 500.0]
    assert sum(evidence.probabilities((6.0, 12.0))) == pytest.approx(1.0)
