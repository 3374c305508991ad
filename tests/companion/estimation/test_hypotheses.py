"""Which sensor is wrong: evidence on synthetic sequences, detection times and false alarms."""

import cmath
import math
import random

import pytest
from fix_errors import scatter

from companion.estimation.hypotheses import THRESHOLDS, SensorBank, SuspectedSensor

TICK_S = 0.2
CURRENT_M_S = complex(0.4, -0.3)


class Passage:
    """A boat on a steady course: a filter that follows the compass within two seconds, and the bank."""

    def __init__(self, speed_m_s: float = 2.0) -> None:
        self.bank = SensorBank()
        self.verdict: SuspectedSensor | None = None
        self.now_s = self.told_s = 0.0
        self.error_rad = math.inf
        self._speed_m_s, self._rng = speed_m_s, random.Random(4)
        self._filter_rad = self._corrected_rad = 0.0

    def sail(
        self, seconds: float, compass_rad_s: float = 0.0, gyro_rad_s: float = 0.0
    ) -> SuspectedSensor | None:
        """Go on until a verdict; compass and gyro drift by so much. The true heading is 0."""
        bank, lie_rad = self.bank, 0.0
        for _ in range(round(seconds / TICK_S)):
            self.now_s += TICK_S
            lie_rad += compass_rad_s * TICK_S
            heard_rad = lie_rad + self._rng.gauss(0.0, 0.01)
            self._filter_rad += gyro_rad_s * TICK_S
            step = (TICK_S / 2.0) * (heard_rad - self._filter_rad)
            self._filter_rad += step
            self._corrected_rad += step
            bank.follow(self._corrected_rad, 0.0, CURRENT_M_S, 0.0, TICK_S)
            noise = complex(self._rng.gauss(0.0, 0.08), self._rng.gauss(0.0, 0.08))
            ground = CURRENT_M_S + self._speed_m_s + noise
            through = cmath.rect(self._speed_m_s, self._filter_rad)
            self.verdict = bank.weigh_velocity(ground, through, 0.0, 0.01, TICK_S)
            if self.verdict is not None:
                self.error_rad = abs(self._filter_rad + bank.gap_rad)
                break
        return self.verdict


@pytest.mark.parametrize("deg_s", [-4.0, 1.0])
def test_a_compass_that_drifts_is_found_out_and_the_gyro_knows_the_heading(deg_s: float) -> None:
    passage = Passage()
    passage.sail(60.0)
    assert passage.sail(30.0, compass_rad_s=math.radians(deg_s)) is SuspectedSensor.COMPASS
    assert passage.now_s - 60.0 < 4.0 + 10.0 / abs(deg_s)
    assert passage.error_rad < math.radians(3.0)


def test_without_way_the_gyro_is_taken_to_be_wrong_after_two_minutes() -> None:
    passage = Passage(speed_m_s=0.02)
    passage.sail(60.0)
    assert passage.sail(100.0, compass_rad_s=math.radians(2.0)) is None
    assert passage.sail(60.0, compass_rad_s=math.radians(2.0)) is SuspectedSensor.GYRO


def test_a_wrong_compass_has_to_agree_for_twenty_seconds() -> None:
    bank = SensorBank()
    bank.reject_compass()
    assert bool(bank.is_compass_wrong) is True
    assert bank.evidence.against[SuspectedSensor.COMPASS] == THRESHOLDS[SuspectedSensor.COMPASS]
    assert not any(bank.acquit_compass(agrees=True, dt_s=1.0) for _ in range(19))
    assert not bank.acquit_compass(agrees=False, dt_s=1.0), "one reading that is off, and it begins again"
    assert not any(bank.acquit_compass(agrees=True, dt_s=1.0) for _ in range(19))
    assert bank.acquit_compass(agrees=True, dt_s=1.0)
    assert not bank.is_compass_wrong
    assert bank.evidence.against[SuspectedSensor.COMPASS] == 0.0


def alarm_s(
    seed: int,
    seconds: float,
    *,
    drift_m_s: float = 0.0,
    rate_hz: float = 5.0,
    wander_m: float = 0.15,
    noise_m: float = 0.1,
    bias_m_s: float = 0.0,
    jump_m: float = 0.0,
    noise_m_s: float = 0.0,
) -> float:
    """When positions are said to contradict their velocities; they drift, jump or scatter more and more after
    120 s.
    """
    error = scatter(max(0.2, noise_m / 0.6), 0.08)  # as learned; six tenths are white
    rng, bank = random.Random(seed), SensorBank()
    dt_s, wander, now_s = 1.0 / rate_hz, 0j, 0.0
    keep = math.exp(-dt_s / 30.0)

    def gauss(sigma: float) -> complex:
        return complex(rng.gauss(0.0, sigma), rng.gauss(0.0, sigma))

    while now_s < seconds:
        now_s += dt_s
        wander = keep * wander + gauss(wander_m * math.sqrt(1.0 - keep * keep))
        late_s = max(now_s - 120.0, 0.0)
        at = 20.0 * cmath.rect(1.0, 0.1 * now_s) + wander + gauss(noise_m + noise_m_s * late_s)
        at += drift_m_s * late_s + (jump_m if late_s > 0.0 else 0.0)
        velocity = 2.0j * cmath.rect(1.0, 0.1 * now_s) + gauss(0.08) + bias_m_s
        bank.weigh_position(now_s, at, velocity, velocity, error, 1.0, 1.0)
        if bank.is_gnss_wrong:
            return now_s - 120.0
    return math.inf


@pytest.mark.parametrize(
    ("drift_m_s", "most_s", "rate_hz"), [(1.0, 3.0, 5.0), (0.5, 7.5, 1.0), (0.1, 45.0, 5.0)]
)
def test_positions_that_drift_from_their_velocities_are_found_out(
    drift_m_s: float, most_s: float, rate_hz: float
) -> None:
    for seed in range(3):
        assert 0.0 < alarm_s(seed, 200.0, drift_m_s=drift_m_s, rate_hz=rate_hz) < most_s


@pytest.mark.parametrize("noise_m_s", [0.1, 0.5, 1.6])
def test_noise_that_grows_is_no_drift(noise_m_s: float) -> None:
    for seed in range(5):
        assert alarm_s(seed, 130.0, noise_m_s=noise_m_s) == math.inf


def test_the_drift_is_known_and_a_jump_back_ends_it() -> None:
    bank, drift_m = SensorBank(), 0.0
    for tick in range(1, 300):
        at_m = 0.5 * max(0.2 * tick - 20.0, 0.0)
        bank.weigh_position(0.2 * tick, at_m, 0j, 0j, scatter(0.2), 1.0, 1.0)
        drift_m = max(drift_m, bank.drift.drift_m)
    assert bank.is_gnss_wrong
    assert bank.evidence.against[SuspectedSensor.GNSS] > THRESHOLDS[SuspectedSensor.GNSS]
    assert drift_m == pytest.approx(0.5 * 30.0, abs=1.5)
    bank.weigh_position(60.0, 0.0, 0j, 0j, scatter(0.2), 1.0, 1.0)
    assert not bank.is_gnss_wrong
