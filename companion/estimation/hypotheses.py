"""Which sensor is wrong: a bank of hypotheses, decided by likelihood.

A filter that is taught by a wrong sensor fits it in the end, so innovations alone do not tell slow faults.
Beside the filter goes a shadow for each hypothesis: a quantity that the suspected sensor does not reach. The
log likelihood ratio of the measurements by the shadow and by the filter is summed as evidence
(`companion.core.evidence`; the generalized likelihood ratio of A. S. Willsky, H. L. Jones, IEEE Trans.
Automatic Control 21(1), 1976; arbitration as in a bank of filters: Y. Bar-Shalom, X. R. Li, T. Kirubarajan,
*Estimation with Applications to Tracking and Navigation*, 2001, section 11.6):

    compass wrong   the heading by the gyro alone explains the velocity over ground better than the compass's
    gyro wrong      the compass's heading explains it better
    GNSS wrong      positions drift steadily from the integral of their own velocities

Horizontal vectors are complex numbers, north + i east.
"""

import cmath
import math
from collections import deque
from enum import IntEnum
from typing import Final

from companion.core.evidence import LEARNING, MOST_SQUARE, FaultEvidence

# Of evidence, in nats, that proves a fault. With samples 1 s apart that count, one false alarm in exp(12) s =
# 45 h of positions. Headings are judged only while they differ by GAP_RAD, which is rare: odds of 400 to 1.
THRESHOLDS: Final[list[float]] = [6.0, 6.0, 15.0]
GAP_RAD: Final = 0.12  # three standard deviations of a compass that heels in turns and feels the motors
_HEADING_S: Final = 20.0  # time constant of the gyro's heading towards the filter's,
_BIAS_S: Final = 60.0  # and of its bias; both shorter in the first minute
_LEAST_S: Final = 2.0
_YOUNG: Final = 0.7  # of its age
_KEEP_S: Final = 4.0  # the current is kept from one to two of these periods ago
_GIVE_UP_S: Final = 120.0  # without a decision after this, the gyro is taken to be wrong: it is seldom in use
_MODEL_S: Final = 1.0  # correlation time of the modelled velocity's error
_AGREES_S: Final = 20.0  # for which a wrong compass has to agree until it is trusted again
_AGREES_RAD: Final = 0.2
_STEADY_RAD: Final = 0.1
_WINDOW: Final = 15  # onsets of a drift that are considered,
_ONSET_S: Final = 2.0  # so far apart: half a minute
_UNDERSTATED: Final = 1.5  # the slow error of a receiver under trees, in those that it states
_DOPPLER_BIAS_M_S: Final = 0.01  # standard deviation of a receiver's constant velocity error
_NOISE_S: Final = 30.0  # time constant of the learned noise,
_FIRST_NOISE: Final = 4.0  # and its initial value: two of the stated standard deviations


class Sensor(IntEnum):
    """The hypotheses of the bank: this sensor is wrong."""

    COMPASS = 0
    GYRO = 1
    GNSS = 2


class DriftTest:
    """Whether positions part from the integral of their velocities: a generalized likelihood ratio.

    The onset may lie up to half a minute back. drift_m: since the likeliest one. steady_s: time since a jump.
    """

    def __init__(self, wander_s: float) -> None:
        """wander_s: correlation time of a receiver's error."""
        self._wander_s = wander_s
        self._noise = _FIRST_NOISE  # learned factor of the variances
        self._past: deque[tuple[float, complex]] = deque(maxlen=_WINDOW + 1)
        self._last_s, self._last_m = -math.inf, 0j
        self.restart()

    def restart(self) -> None:
        """Forget the past: a drift begins now at the earliest."""
        self._past.clear()
        self.drift_m = self.steady_s = 0.0

    def update(
        self, time_s: float, rest_m: complex, wander_m2: float, white_m2: float, walk_m2_s: float
    ) -> float:
        """Evidence for a drift, in nats.

        rest_m: position less the integral of the velocities. Variances per axis: of the receiver's slow error
        and of the noise of a position; walk_m2_s: growth by the noise of the velocities.
        """
        dt_s, step = time_s - self._last_s, _square(rest_m - self._last_m)
        self._last_s, self._last_m = time_s, rest_m
        if self._past:
            usual = 2.0 * white_m2 + (2.0 * wander_m2 / self._wander_s + walk_m2_s) * dt_s
            ratio = 0.5 * step / usual
            if ratio > MOST_SQUARE * self._noise:  # a jump, which the filter's gate decides on
                self.restart()
            else:
                learned = min(dt_s / _NOISE_S, 0.2) * (min(ratio, 4.0 * self._noise) - self._noise)
                self._noise = max(self._noise + learned, 1.0)
                self.steady_s += dt_s
        most = self.drift_m = 0.0
        for then_s, then_m in self._past:
            for_s = time_s - then_s
            variance = 2.0 * wander_m2 * (1.0 - math.exp(-for_s / self._wander_s)) + walk_m2_s * for_s
            variance = self._noise * (variance + 2.0 * white_m2) + (_DOPPLER_BIAS_M_S * for_s) ** 2
            nats = 0.5 * _square(rest_m - then_m) / variance
            if nats > most:
                most, self.drift_m = nats, abs(rest_m - then_m)
        if not self._past or time_s - self._past[-1][0] >= _ONSET_S:
            self._past.append((time_s, rest_m))
        return most


class SensorBank:
    """gap_rad: heading by the gyro alone less that by the compass, clockwise; bias_rad_s: its gyro bias.

    current_m_s and offset_rad: current and compass offset from before the headings parted.
    """

    def __init__(self, wander_s: float, wander_share: float) -> None:
        """wander_s and wander_share: of the receiver's error (`Estimation`)."""
        self.evidence = FaultEvidence(len(Sensor))
        self.current_m_s, self.offset_rad = self._newer = 0j, 0.0
        self.is_compass_wrong = self.is_gnss_wrong = False
        self._recorded_s = math.inf
        self._agreed_rad = self._agrees_s = 0.0
        self.drift = DriftTest(wander_s)
        self._wander_share = wander_share
        self._fix_s = -math.inf
        self._way_m = self._velocity = 0j
        self.restart(0.0, 0.0)

    def hypotheses(self) -> tuple[tuple[str, float], ...]:
        """Name and probability of each."""
        shares = self.evidence.probabilities(THRESHOLDS)
        return tuple(
            (f"{sensor.name.lower()} wrong", share) for sensor, share in zip(Sensor, shares, strict=True)
        )

    def restart(self, compass_rad: float, bias_rad_s: float) -> None:
        """Follow the compass from here on. compass_rad: see `turn`."""
        self._compass_rad, self.bias_rad_s = compass_rad, bias_rad_s
        self.gap_rad = self._age_s = self._parted_s = 0.0
        self.evidence.against[Sensor.COMPASS] = self.evidence.against[Sensor.GYRO] = 0.0

    def turn(self, compass_rad: float, bias_rad_s: float, dt_s: float) -> None:
        """Advance the gyro's heading by dt_s.

        compass_rad: sum of all corrections of the filter's heading, and its compass offset. bias_rad_s: the
        filter's gyro bias.
        """
        gap = self.gap_rad - (compass_rad - self._compass_rad) + (bias_rad_s - self.bias_rad_s) * dt_s
        self._compass_rad = compass_rad
        self._age_s += dt_s
        if self._parted_s == 0.0:
            young_s = max(_YOUNG * self._age_s, _LEAST_S)
            gap -= min(dt_s / min(young_s, _HEADING_S), 1.0) * gap
            self.bias_rad_s += min(dt_s / min(young_s, _BIAS_S), 1.0) * (bias_rad_s - self.bias_rad_s)
        if self._parted_s > 0.0 or abs(gap) > GAP_RAD:
            self._parted_s += dt_s
        self.gap_rad = gap

    def keep(self, current_m_s: complex, offset_rad: float, dt_s: float) -> None:
        """Keep current and compass offset while the headings agree."""
        self._recorded_s += dt_s
        if self._recorded_s >= _KEEP_S and self._parted_s == 0.0:
            now = current_m_s, offset_rad
            self.current_m_s, self.offset_rad = now if self._recorded_s == math.inf else self._newer
            self._newer = now
            self._recorded_s = 0.0

    def weigh_velocity(
        self, over_ground: complex, through: complex, offset_rad: float, variance: float, dt_s: float
    ) -> Sensor | None:
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
        gain = min(_square(off - by_compass) / variance, most) - min(_square(off - by_gyro) / variance, most)
        gain *= 0.5 * min(dt_s / _MODEL_S, 1.0)
        for sensor, ratio in ((Sensor.COMPASS, gain), (Sensor.GYRO, -gain)):
            self.evidence.add(sensor, ratio, dt_s)
            if self.evidence.against[sensor] > THRESHOLDS[sensor]:
                return sensor
        return Sensor.GYRO if self._parted_s > _GIVE_UP_S else None

    def reject_compass(self) -> None:
        """The compass is wrong, and the filter has been set to the gyro's heading and bias."""
        self.is_compass_wrong = True
        self._agreed_rad = self._agrees_s = 0.0
        self.evidence.against[Sensor.COMPASS] = THRESHOLDS[Sensor.COMPASS]

    def acquit_compass(self, innovation_rad: float, dt_s: float, *, is_idle: bool) -> bool:
        """Whether a compass that was wrong has agreed with the filter for long enough.

        is_idle: without way nothing corrects the filter's heading, and a steady innovation is enough.
        """
        if abs(math.remainder(innovation_rad - self._agreed_rad, math.tau)) > _STEADY_RAD:
            self._agreed_rad, self._agrees_s = innovation_rad, 0.0
        self._agrees_s = self._agrees_s + dt_s if is_idle or abs(innovation_rad) < _AGREES_RAD else 0.0
        self.is_compass_wrong = self._agrees_s < _AGREES_S
        left = max(1.0 - self._agrees_s / _AGREES_S, 0.0)
        self.evidence.against[Sensor.COMPASS] = left * THRESHOLDS[Sensor.COMPASS]
        return not self.is_compass_wrong

    def weigh_position(
        self,
        time_s: float,
        at: complex,
        velocity: complex,
        sigma_m: float,
        velocity_variance: float,
        *,
        is_measured: bool = True,
    ) -> float:
        """Whether positions drift from their own velocities; sets `is_gnss_wrong`.

        velocity: if not is_measured, the filter's, by which jumps are detected but no drift is proved.
        sigma_m: of the position, per axis. velocity_variance: per axis. Returns by how much they have drifted
        apart, 0 while that is not proved.
        """
        dt_s, self._fix_s = time_s - self._fix_s, time_s
        before, self._velocity = self._velocity, velocity
        evidence = 0.0
        if not dt_s < _LEAST_S:
            self.drift.restart()
        else:
            self._way_m += 0.5 * dt_s * (before + velocity)
            share = self._wander_share * self._wander_share
            evidence = self.drift.update(
                time_s,
                at - self._way_m,
                _UNDERSTATED**2 * share * sigma_m**2,
                (1.0 - share) * sigma_m**2,
                velocity_variance * dt_s,
            )
        if not is_measured:
            evidence = 0.0
        self.evidence.against[Sensor.GNSS] = evidence
        self.is_gnss_wrong = evidence > (LEARNING if self.is_gnss_wrong else THRESHOLDS[Sensor.GNSS])
        return self.drift.drift_m if self.is_gnss_wrong else 0.0


def _square(vector: complex) -> float:
    return vector.real * vector.real + vector.imag * vector.imag
