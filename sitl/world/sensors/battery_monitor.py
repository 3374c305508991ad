"""The battery monitor: voltage and current at the pack's terminals."""

import msgspec

from companion.sensors.readings import BatteryReading
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.sampling import TIME_SLACK_S, generator, normal
from sitl.world.sensors.sensor import Sensor
from sitl.world.sensors.settings import BatteryMonitorSettings

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
        if now_s < self.due_s:
            return
        self._count += 1
        self.due_s = self._count / self._rate_hz - TIME_SLACK_S
        settings = self._settings
        current_a *= settings.current_gain
        if self._is_noisy:
            voltage_v += settings.voltage_noise_v * normal(self._random)
            current_a += settings.current_noise_a * normal(self._random)
        reading = BatteryReading(now_s + self.clock_offset_s, voltage_v, current_a)
        if self.fault is None:
            self._latest = self._sampled = reading
        else:
            faulty = self._with_fault(reading, self.fault, now_s)
            if faulty is not None:
                self._latest = faulty

    def _with_fault(
        self, reading: BatteryReading, fault: SensorFault[BatteryReading], now_s: float
    ) -> BatteryReading | None:
        replace = msgspec.structs.replace
        match fault.kind:
            case "stuck":
                held = fault.hold(self._sampled, reading)
                return replace(held, time_s=reading.time_s)
            case "garbage":
                uniform = fault.random.uniform
                return replace(reading, voltage_v=uniform(0.0, 32.0), current_a=uniform(-50.0, 50.0))
            case "wrong":
                return replace(reading, voltage_v=max(0.0, reading.voltage_v + fault.size))
            case _:
                return fault.output_at(reading, now_s)
