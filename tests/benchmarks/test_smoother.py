"""The smoother that the boat's track is compared with."""

import math
import random

import numpy as np

from benchmarks.estimation.smoother import RecordedRun, measure, rms, smooth
from sitl.world.sensors.receivers import GnssSettings

RECEIVER = GnssSettings(noise_m=0.1, wander_m=0.6, slow_m=0.0, velocity_noise_m_s=0.08)


def test_a_smoother_of_fixes_without_errors_is_where_they_are() -> None:
    times_s = np.arange(0.0, 60.0, 0.2)
    at = 5.0 * np.sin(0.1 * times_s)
    fixes = np.column_stack((at, 0.5 * np.cos(0.1 * times_s)))
    assert rms(smooth(times_s, fixes, RECEIVER, 0.1) - at) < 0.02


def test_a_smoother_errs_by_less_than_its_fixes_and_by_what_its_model_lets_expect() -> None:
    rng, times_s = random.Random(3), np.arange(0.0, 300.0, 0.2)
    wander = doppler = 0.0
    keep, lasts = math.exp(-0.2 / 60.0), math.exp(-0.2)
    fixes, raw = [], []
    for time_s in times_s.tolist():
        wander = keep * wander + 0.6 * math.sqrt(1.0 - keep * keep) * rng.gauss(0.0, 1.0)
        doppler = lasts * doppler + 0.08 * math.sqrt(1.0 - lasts * lasts) * rng.gauss(0.0, 1.0)
        raw.append(wander + rng.gauss(0.0, 0.1))
        fixes.append((2.0 * time_s + raw[-1], 2.0 + doppler))
    smoothed = smooth(times_s, np.array(fixes), RECEIVER, 0.01) - 2.0 * times_s
    assert 0.1 < rms(smoothed) < 0.95 * rms(np.array(raw))


def test_the_boat_is_off_its_true_legs_by_little_more_than_the_smoother() -> None:
    figures = measure(RecordedRun("rtk", "square", 1003))
    assert 0.03 < figures.smoother < figures.boat < 0.3
    assert figures.estimate < 0.25
