"""Readings that have become late: by how much, and after how long that is known."""

import cmath
import math
import random

import pytest

from companion.estimation.delay import PAUSE_S, DelayEstimator


def swing(time_s: float) -> complex:
    """A boat that goes about now and then."""
    return cmath.rect(2.0, math.sin(0.7 * time_s) + 0.5 * math.sin(0.23 * time_s))


def watched(
    late_s: float, paused_s: float, seconds: float = 60.0, noise: float = 0.1, scale: float = 1.0
) -> tuple[DelayEstimator, float]:
    """An estimator over readings that become late after 20 s, with a pause; and when it has changed first."""
    late, rng, heard_s, changed_s = DelayEstimator(0.2), random.Random(5), 0.0, math.inf
    for tick in range(round(seconds / 0.1)):
        now_s = 0.1 * tick
        late.add_expected(now_s, swing(now_s))
        if tick % 2 or 20.0 <= now_s < 20.0 + paused_s:
            continue
        if now_s - heard_s > PAUSE_S:
            late.note_gap(now_s, now_s - heard_s)
        heard_s = now_s
        then_s = now_s - (late_s if now_s >= 20.0 else 0.0)
        noisy = complex(rng.gauss(0.0, noise), rng.gauss(0.0, noise))
        if late.compare(now_s, scale * swing(then_s) + complex(0.5, -0.3) + noisy):
            changed_s = min(changed_s, now_s - 20.0 - paused_s)
    return late, changed_s


@pytest.mark.parametrize(("late_s", "most_s"), [(0.6, 8.0), (2.8, 4.0)])
def test_readings_that_have_become_late_say_by_how_much(late_s: float, most_s: float) -> None:
    late, changed_s = watched(late_s, late_s)
    assert late.delay_s == pytest.approx(late_s, abs=0.21)
    assert changed_s < most_s


def test_readings_that_are_in_time_again_are_believed_again() -> None:
    late, delays = DelayEstimator(0.2), []
    for tick in range(900):
        now_s = 0.1 * tick
        late.add_expected(now_s, swing(now_s))
        if 20.0 <= now_s < 22.0:
            continue
        if now_s == 22.0:
            late.note_gap(now_s, 2.0)
        late.compare(now_s, swing(now_s - (2.0 if 20.0 <= now_s < 50.0 else 0.0)))
        delays.append(late.delay_s)
    assert max(delays) == pytest.approx(2.0, abs=0.21)
    assert delays[-1] == 0.0


def test_a_sensor_that_is_slow_as_a_rule_is_not_doubted_for_it() -> None:
    late = DelayEstimator(0.2)
    for second in range(1, 200):
        late.note_gap(float(second), 1.0)
    assert not late.is_watching(200.0)
    late.note_gap(203.0, 3.0)
    assert late.is_watching(203.5)
