"""The battery monitor: voltage and current at the pack's terminals."""

import msgspec

from companion.core.readings import BatteryReading
from sitl.world.sampling import generator, normal
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.sensor import Sensor
from sitl.world.sensors.settings import BatteryMonitorSettings

_FULL_SCALE_V, _FULL_SCALE_A = 40.96, 81.92  # INA226 with a shunt of 1 mΩ
_PERFECT = BatteryMonitorSettings()


class SimBattery(Sensor[BatteryReading]):
    """The monitor of the simulated pack."""

    def __init__(self, rate_hz: float, settings: BatteryMonitorSettings = _PERFECT, seed: int = 0) -> None:
        super().__init__()
        self._rate_hz = rate_hz
        self._settings = settings
        self._random = generator(seed, "battery")
        self._is_noisy = bool(settings.voltage_noise_v or settings.current_noise_a)

    def sample(self, now_s: float, voltage_v: float, current_a: float) -> None:
        """Sample when due."""
        if not self._is_due(now_s, self._rate_hz):
            return
        settings = self._settings
        current_a *= settings.current_gain
        if self._is_noisy:
            voltage_v += settings.voltage_noise_v * normal(self._random)
            current_a += settings.current_noise_a * normal(self._random)
        is_known = settings.max_current_a == 0.0 or abs(current_a) <= settings.max_current_a
        reading = BatteryReading(now_s + self.clock_offset_s, voltage_v, current_a if is_known else None)
        self._output(reading, now_s)

    def _with_fault(
        self, reading: BatteryReading, fault: SensorFault[BatteryReading], now_s: float
    ) -> BatteryReading | None:
        replace = msgspec.structs.replace
        match fault.kind:
            case "garbage":
                uniform = fault.random.uniform
                return replace(reading, voltage_v=uniform(0.0, 32.0), current_a=uniform(-50.0, 50.0))
            case "corrupt":
                return fault.corrupt(reading, voltage_v=_FULL_SCALE_V, current_a=_FULL_SCALE_A)
            case "wrong":
                return replace(reading, voltage_v=max(0.0, reading.voltage_v + fault.size))
            case _:
                return super()._with_fault(reading, fault, now_s)
