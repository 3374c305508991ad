"""Speed controllers that report by frames of KISS: speed, current and voltage of each shaft."""

import math
from collections.abc import Sequence
from typing import Any, Final

from companion.config.actuators import MotorsPart
from companion.core.readings import EscReading
from sitl.world.drive.thruster import Thruster
from sitl.world.sampling import generator, normal
from sitl.world.sensors.sensor import Sensor

_RATE_HZ: Final = 30.0  # AM32: every 30 ms
_STEP_ERPM: Final = 100.0  # of a frame
# White, one standard deviation: the converters of a cheap controller, whose steps are 0.03 V and 0.1 A
_NOISE_V, _NOISE_A = 0.03, 0.15
_TEMPERATURE_C: Final = 35.0


class SimEscs(Sensor[Any]):
    """Satisfies `companion.hal.interfaces.EscTelemetry`: a reading of each, and no faults."""

    def __init__(self, part: MotorsPart, shafts: Sequence[Thruster], seed: int) -> None:
        super().__init__()
        self._step_rad_s = _STEP_ERPM / part.pole_pairs * math.tau / 60.0
        self._shafts = shafts
        self._random = generator(seed, "escs")
        self._consumed_mah = [0.0] * len(shafts)

    def sample(self, now_s: float, voltage_v: float) -> None:
        """Sample when due."""
        if not self._is_due(now_s, _RATE_HZ):
            return
        readings = []
        for side, shaft in enumerate(self._shafts):
            self._consumed_mah[side] += shaft.current_a / _RATE_HZ / 3.6
            readings.append(
                EscReading(
                    now_s + self.clock_offset_s,
                    side,
                    self._count,
                    self._step_rad_s * round(abs(shaft.speed_rad_s) / self._step_rad_s),
                    max(voltage_v + _NOISE_V * normal(self._random), 0.0),
                    max(shaft.current_a + _NOISE_A * normal(self._random), 0.0),
                    _TEMPERATURE_C,
                    self._consumed_mah[side],
                )
            )
        self._latest = tuple(readings)
