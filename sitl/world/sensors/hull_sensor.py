"""The hull's water probe and thermometer."""

from typing import Final

from companion.core.readings import HullReading
from sitl.world.sampling import TIME_SLACK_S
from sitl.world.sensors.sensor import Sensor
from sitl.world.sensors.settings import HullSensorSettings

PERIOD_S: Final = 1.0
HOTTEST_C: Final = 110.0


class SimHullSensor(Sensor[HullReading]):
    """Dry and at the temperature of the settings, unless changed by faults or parameters.

    is_wet: water at the probe; None: the probe says nothing. offset_c: what the thermometer is off by;
    warming_c_s: how fast it gets hotter, up to HOTTEST_C; hears_heat: False for a thermometer that is silent.
    """

    def __init__(self, settings: HullSensorSettings) -> None:
        super().__init__()
        self.is_wet: bool | None = False
        self.hears_heat = True
        self.offset_c = 0.0
        self.warming_c_s = 0.0
        self._hot_since_s = 0.0
        self._temperature_c = settings.temperature_c

    def set_warming(self, warming_c_s: float, now_s: float) -> None:
        """Set the heating rate; 0 ends it."""
        self.warming_c_s, self._hot_since_s = warming_c_s, now_s

    def set_temperature(self, temperature_c: float) -> None:
        """Set the temperature in the hull."""
        self._temperature_c = temperature_c

    def sample(self, now_s: float) -> None:
        """Sample when due."""
        if now_s < self.due_s:
            return
        self.due_s = now_s + PERIOD_S - TIME_SLACK_S
        temperature_c: float | None = None
        if self.hears_heat:
            temperature_c = self._temperature_c + self.offset_c
            if self.warming_c_s:
                grown_c = temperature_c + self.warming_c_s * (now_s - self._hot_since_s)
                temperature_c = max(temperature_c, min(HOTTEST_C, grown_c))
        self._latest = HullReading(now_s + self.clock_offset_s, self.is_wet, temperature_c)
