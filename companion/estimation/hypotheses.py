"""Which sensor is wrong: a bank of hypotheses, decided by likelihood.

A filter that is taught by a wrong sensor fits it in the end, so innovations alone do not tell slow faults.
Beside the filter goes a shadow: heading, gyro bias, current and compass offset that the suspected sensor does
not reach, since they follow the filter slowly. The log likelihood ratio of the measurements by the shadow and
by the filter is summed as evidence (`companion.core.evidence`; the generalized likelihood ratio of A. S.
Willsky, H. L. Jones, IEEE Trans. Automatic Control 21(1), 1976; arbitration as in a bank of filters: Y.
Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001, section
11.6):

    compass wrong   the heading by the gyro alone explains the velocity over ground better than the compass's
    gyro wrong      the compass's heading explains it better
    GNSS wrong      positions drift steadily from the integral of their own velocities

Horizontal vectors are complex numbers, north + i east.
"""

import cmath
import math
from collections import deque
from enum import IntEnum, auto
from typing import Final

from companion.core.evidence import LEARNING, MOST_SQUARE, FaultEvidence
from companion.estimation.fix_error import FixError
from companion.estimation.innovation import square

# Of evidence, in nats, that proves a fault. Sound receivers of all classes reach 8 nats of a drift 20 to 40
# times an hour at rest, and each further nat 2.2 times as seldom; under way, where the class's slow error is
# all that is known, 15 nats were reached three times in two hours: 22 once in weeks. Headings are judged
# only while they differ by GAP_RAD, which is rare: odds of 400 to 1.
THRESHOLDS: Final = (6.0, 6.0, 22.0)
GAP_RAD: Final = 0.12  # three standard deviations of a compass that heels in turns and feels the motors
# Time constant of the shadow: a few turns; shorter at first. A wrong compass has to agree for as long.
_SHADOW_S: Final = 20.0
_UNDECIDED_S: Final = 120.0  # without a decision, the gyro is doubted: it is seldom in use
_ONSETS: Final = 15  # of a drift that are considered,
_ONSET_S: Final = 2.0  # so far apart: half a minute


class SuspectedSensor(IntEnum):
    """The hypotheses of the bank: this sensor is wrong."""

    COMPASS = 0
    GYRO = auto()
    GNSS = auto()


class DriftTest:
    """Whether positions part from the integral of their velocities: a generalized likelihood ratio.

    The onset may lie up to half a minute back. What changes from one position to the next since then is
    noise, and no drift (J. von Neumann's mean square successive difference, Annals of Mathematical Statistics
    12, 1941). drift_m: since the likeliest onset. steady_s: time since a jump.
    """

    def __init__(self) -> None:
        self._past: deque[tuple[float, complex, float, int]] = deque(maxlen=_ONSETS)
        self._steps_m2, self._count = 0.0, 0
        self._last_s, self._last_m, self._velocity, self._way_m = -math.inf, 0j, 0j, 0j
        self.restart()

    def restart(self) -> None:
        """Forget the past: a drift begins now at the earliest."""
        self._past.clear()
        self.drift_m = self.steady_s = 0.0

    def update(
        self, time_s: float, at: complex, velocity: complex, error: FixError, noise: float, doppler: float
    ) -> float:
        """Evidence for a drift, in nats. noise, doppler: learned factors of the white noise of the position
        and of the velocity's.
        """
        dt_s, self._last_s = time_s - self._last_s, time_s
        if dt_s > _ONSET_S:
            self.restart()
        else:
            self._way_m += 0.5 * dt_s * (self._velocity + velocity)
        rest_m, before_m, self._velocity = at - self._way_m, self._last_m, velocity
        self._last_m = rest_m
        white, wander, wander_s = noise * error.white_m2, error.wander_m2, error.wander_s
        walk = doppler * error.density * error.velocity_m2_s2 * dt_s
        step_m2 = 0.25 * square(rest_m - before_m)
        self._steps_m2 += step_m2
        self._count += 1
        if self._past:
            usual = white + (wander / wander_s + 0.5 * walk) * dt_s
            if step_m2 > MOST_SQUARE * usual:  # a jump: the filter's gate decides
                self.restart()
            else:
                self.steady_s += dt_s
        most = self.drift_m = 0.0
        for then_s, then_m, steps_m2, count in self._past:
            for_s = time_s - then_s
            # by the latest step, too: the noise may just have grown
            scatter = max(white, step_m2, (self._steps_m2 - steps_m2) / (self._count - count))
            spread = scatter + wander * (1.0 - math.exp(-for_s / wander_s)) + 0.5 * walk * for_s
            nats = 0.25 * square(rest_m - then_m) / spread
            if nats > most:
                most, self.drift_m = nats, abs(rest_m - then_m)
        if not self._past or time_s - self._past[-1][0] >= _ONSET_S:
            self._past.append((time_s, rest_m, self._steps_m2, self._count))
        return most


class SensorBank:
    """gap_rad: the shadow's heading less the compass's. Its bias_rad_s, current_m_s, offset_rad."""

    def __init__(self) -> None:
        self.evidence = FaultEvidence(len(SuspectedSensor))
        self.is_compass_wrong = self.is_gnss_wrong = False
        self.current_m_s, self.offset_rad = 0j, 0.0
        self._agrees_s = 0.0
        self.drift = DriftTest()
        self.restart(0.0, 0.0)

    def probabilities(self) -> list[float]:
        """Of each sensor to be wrong."""
        return self.evidence.probabilities(THRESHOLDS)

    def hypotheses(self) -> tuple[tuple[str, float], ...]:
        """Name and probability of each."""
        return tuple(
            (f"{sensor.name.lower()} wrong", share)
            for sensor, share in zip(SuspectedSensor, self.probabilities(), strict=True)
        )

    def restart(self, compass_rad: float, bias_rad_s: float) -> None:
        """Follow the compass from here on. compass_rad: see `follow`."""
        self._compass_rad, self.bias_rad_s = compass_rad, bias_rad_s
        self.gap_rad = self._age_s = self._parted_s = 0.0
        self.evidence.against[SuspectedSensor.COMPASS] = self.evidence.against[SuspectedSensor.GYRO] = 0.0

    def follow(
        self, compass_rad: float, bias_rad_s: float, current_m_s: complex, offset_rad: float, dt_s: float
    ) -> None:
        """Advance the shadow by dt_s: it follows these of the filter unless the headings have parted.

        compass_rad: sum of all corrections of the filter's heading, and its compass offset.
        """
        self.gap_rad += self._compass_rad - compass_rad + (bias_rad_s - self.bias_rad_s) * dt_s
        self._compass_rad = compass_rad
        if self._parted_s > 0.0 or abs(self.gap_rad) > GAP_RAD:
            self._parted_s += dt_s
            return
        self._age_s += dt_s
        share = dt_s / min(self._age_s, _SHADOW_S)
        self.gap_rad -= share * self.gap_rad
        self.current_m_s += share * (current_m_s - self.current_m_s)
        self.offset_rad += share * (offset_rad - self.offset_rad)
        self.bias_rad_s += share * (bias_rad_s - self.bias_rad_s)

    def weigh_velocity(
        self, over_ground: complex, through: complex, offset_rad: float, variance: float, dt_s: float
    ) -> SuspectedSensor | None:
        """Which of compass and gyro is proved wrong by a measured velocity.

        through: velocity through the water by the filter's heading; offset_rad: its compass offset; variance:
        of the difference between measured and modelled velocity, per axis.
        """
        if self._parted_s == 0.0:
            return None
        off = over_ground - self.current_m_s
        by_compass = through * cmath.rect(1.0, offset_rad - self.offset_rad)
        by_gyro = by_compass * cmath.rect(1.0, self.gap_rad)
        most = 2.0 * MOST_SQUARE
        gain = min(square(off - by_compass) / variance, most) - min(square(off - by_gyro) / variance, most)
        gain *= 0.5 * min(dt_s, 1.0)  # the modelled velocity's error lasts for about a second
        for sensor, ratio in ((SuspectedSensor.COMPASS, gain), (SuspectedSensor.GYRO, -gain)):
            self.evidence.add(sensor, ratio, dt_s)
            if self.evidence.against[sensor] > THRESHOLDS[sensor]:
                return sensor
        return SuspectedSensor.GYRO if self._parted_s > _UNDECIDED_S else None

    def reject_compass(self) -> None:
        """The compass is wrong, and the filter has been set to the gyro's heading and bias."""
        self.is_compass_wrong, self._agrees_s = True, 0.0
        self.evidence.against[SuspectedSensor.COMPASS] = THRESHOLDS[SuspectedSensor.COMPASS]

    def acquit_compass(self, *, agrees: bool, dt_s: float) -> bool:
        """Whether a compass that was wrong has agreed with the filter for long enough."""
        self._agrees_s = self._agrees_s + dt_s if agrees else 0.0
        left = max(1.0 - self._agrees_s / _SHADOW_S, 0.0)
        self.is_compass_wrong = left > 0.0
        self.evidence.against[SuspectedSensor.COMPASS] = left * THRESHOLDS[SuspectedSensor.COMPASS]
        return not self.is_compass_wrong

    def weigh_position(
        self, time_s: float, at: complex, velocity: complex | None, predicted: complex, error: FixError,
        noise: float, doppler: float,
    ) -> None:  # fmt: skip
        """Whether positions drift from their own velocities; sets `is_gnss_wrong`.

        predicted: the filter's velocity, by which jumps are detected, but no drift is proved. noise,
        doppler: as in `DriftTest`.
        """
        way = predicted if velocity is None else velocity
        evidence = self.drift.update(time_s, at, way, error, noise, doppler)
        if velocity is None:
            evidence = 0.0
        self.evidence.against[SuspectedSensor.GNSS] = evidence
        self.is_gnss_wrong = evidence > (LEARNING if self.is_gnss_wrong else THRESHOLDS[SuspectedSensor.GNSS])
