"""The field of the motors at the compass, proportional to their current or throttle.

The boat lies moored; the operator raises the throttle slowly and takes it back. Meanwhile the field in body
axes is that of the earth, turned back by what the gyro has turned, plus the load times a constant vector:

    x = N cos ψ + E sin ψ + m_x I      y = −N sin ψ + E cos ψ + m_y I      z = D + m_z I

which is linear in the unknowns N, E, D and m.
"""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

from companion.config.compass_rows import MOST_MOTOR_MG
from companion.core.fitting import Fit
from companion.core.readings import HeadingReading
from companion.core.vectors import Vector, plus
from companion.sensors.compass.magnetic_field import BY_CURRENT, BY_THROTTLE, MagneticCorrection, MotorLoad

TIMEOUT_S: Final = 120.0
_LEAST_THROTTLE: Final = 0.3  # of a run worth fitting
_REST_THROTTLE: Final = 0.05
_REST_S: Final = 2.0  # at rest after the run, which ends it
_LEAST_CURRENT_A: Final = 0.5  # a smaller difference says nothing about a battery monitor
_MOST_TURN_RAD: Final = math.radians(60.0)  # until then the gyro's drift is small
_LEAST_SAMPLES: Final = 100


class MotorFit(NamedTuple):
    """correction: the one before, with the motors' part. share: of the horizontal field, at the largest load.
    reason: why there is none.
    """

    correction: MagneticCorrection
    share: float = 0.0
    reason: str = ""


class MotorFieldCalibration:
    """Collects readings over one run of the motors. `is_complete`: then call `solve`."""

    def __init__(
        self, before: MagneticCorrection, now_s: float, iron_loads: Sequence[MotorLoad] = ()
    ) -> None:
        """iron_loads: what the motors drew while the iron was calibrated. The offset contains their field,
        which is taken out of it now.
        """
        self.is_complete = False
        self.most_throttle = 0.0
        self._before = before
        self._iron_loads = iron_loads
        self._began_s = now_s
        self._reading_s = -math.inf
        self._turned_rad = 0.0
        self._most_turned_rad = 0.0
        self._rest_s = math.inf
        # Both loads are fitted; which of them is used is known at the end
        self._level = {source: Fit(4) for source in (BY_THROTTLE, BY_CURRENT)}
        self._down = {source: Fit(2) for source in (BY_THROTTLE, BY_CURRENT)}
        self._currents_a = (math.inf, -math.inf)
        self._lacks_current = False

    def progress_percent(self, now_s: float) -> int:
        """Share of the time-out."""
        return min(int(100.0 * (now_s - self._began_s) / TIMEOUT_S), 99)

    def update(self, reading: HeadingReading | None, load: MotorLoad, now_s: float) -> None:
        if reading is not None and reading.field_mg is not None and reading.time_s > self._reading_s:
            dt_s, self._reading_s = reading.time_s - self._reading_s, reading.time_s
            if math.isfinite(dt_s):
                self._turned_rad += (reading.yaw_rate_rad_s or 0.0) * dt_s
            self._most_turned_rad = max(self._most_turned_rad, abs(self._turned_rad))
            self._add(self._before.iron_corrected(reading.field_mg), load)
        self.most_throttle = max(self.most_throttle, load.throttle)
        if load.throttle > _REST_THROTTLE or self.most_throttle < _LEAST_THROTTLE:
            self._rest_s = now_s
        self.is_complete = now_s - self._rest_s > _REST_S or now_s - self._began_s > TIMEOUT_S

    def _add(self, field: Vector, load: MotorLoad) -> None:
        cos, sin = math.cos(self._turned_rad), math.sin(self._turned_rad)
        for source, share in ((BY_THROTTLE, load.throttle), (BY_CURRENT, load.current_a)):
            if share is None:
                self._lacks_current = True
                continue
            self._level[source].add((share, 0.0, cos, sin), field[0])
            self._level[source].add((0.0, share, -sin, cos), field[1])
            self._down[source].add((share, 1.0), field[2])
        if load.current_a is not None:
            low, high = self._currents_a
            self._currents_a = (min(low, load.current_a), max(high, load.current_a))

    def _mean_iron_load(self, source: int) -> float:
        if self._before.motor_source or not self._iron_loads:
            return 0.0  # it was taken out, or is not known
        return sum(load.of(source) for load in self._iron_loads) / len(self._iron_loads)

    def solve(self) -> MotorFit:
        """The motors' part of the correction, by current where it is measured, else by throttle."""
        if self.most_throttle < _LEAST_THROTTLE:
            return MotorFit(self._before, reason=f"the throttle stayed below {100.0 * _LEAST_THROTTLE:.0f} %")
        if self._most_turned_rad > _MOST_TURN_RAD:
            return MotorFit(self._before, reason="the boat turned too far: moor it")
        low, high = self._currents_a
        by_current = not self._lacks_current and high - low >= _LEAST_CURRENT_A
        source, most = (BY_CURRENT, high) if by_current else (BY_THROTTLE, self.most_throttle)
        level, down = self._level[source].solve(), self._down[source].solve()
        if level is None or down is None or self._down[source].count < _LEAST_SAMPLES:
            return MotorFit(self._before, reason="too few readings")
        (ahead, aside, north, east), _ = level
        motor = (-ahead, -aside, -down[0][0])
        if max(map(abs, motor)) > MOST_MOTOR_MG:
            return MotorFit(self._before, reason="the motors' leads are too near: move the compass")
        before = self._before
        offset = plus(before.offset, motor, -self._mean_iron_load(source))
        correction = MagneticCorrection(offset, before.matrix, motor, source)
        return MotorFit(correction, most * math.hypot(ahead, aside) / math.hypot(north, east))
