"""A radio control transmitter and its receiver aboard."""

import math

import msgspec

from companion.core.readings import RcReading
from sitl.world.sampling import TIME_SLACK_S, generator, normal
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.sensor import Sensor
from sitl.world.sensors.settings import RcSettings

_NEUTRAL_US = (1500,) * 16
_THROTTLE = 2  # the third channel, as usual
_GARBAGE_US = (700, 2300)
_NEAR_M = 10.0  # where the signal is as strong as the settings say


class SimRc(Sensor[RcReading]):
    """Plays the scenario's sticks. A transmitter that is switched off leaves its receiver silent; of one that
    is out of range it says so.
    """

    def __init__(self, settings: RcSettings, seed: int, north_m: float = 0.0, east_m: float = 0.0) -> None:
        """Start without a frame, all in the middle. north_m, east_m: where the hand stands."""
        self._north_m, self._east_m = north_m, east_m
        super().__init__()
        self._settings = settings
        self._random = generator(seed, "rc")
        self._channels_us: tuple[int, ...] = _NEUTRAL_US
        self._next = 0  # of the settings' sticks

    def hold(self, channels_us: tuple[int, ...]) -> None:
        """Set sticks and switches until the scenario's next step; none: transmitter off."""
        self._channels_us = channels_us

    def sample(self, now_s: float, north_m: float, east_m: float) -> None:
        """Put out a frame when one is due, if it arrives."""
        settings = self._settings
        if not self._is_due(now_s, settings.rate_hz):
            return
        while self._next < len(settings.sticks) and now_s + TIME_SLACK_S >= settings.sticks[self._next].at_s:
            self._channels_us = settings.sticks[self._next].channels
            self._next += 1
        if not self._channels_us:
            return
        noise_us, numbers = settings.noise_us, self._random
        off_m = math.hypot(north_m - self._north_m, east_m - self._east_m)
        quality = self._quality(off_m)
        if 0.0 < quality < 1.0 and numbers.random() >= quality:
            return
        channels_us = self._channels_us
        if noise_us:
            channels_us = tuple([pulse_us + round(noise_us * normal(numbers)) for pulse_us in channels_us])
        rssi_dbm = settings.rssi_dbm - 20.0 * math.log10(max(off_m / _NEAR_M, 1.0))
        stamp_s = now_s + self.clock_offset_s
        self._output(RcReading(stamp_s, channels_us, quality <= 0.0, quality, rssi_dbm), now_s)

    def _quality(self, off_m: float) -> float:
        """Share of the frames that arrive so far off."""
        settings = self._settings
        if settings.range_m <= 0.0 or off_m <= 0.5 * settings.range_m:
            return settings.quality
        return settings.quality * max(2.0 - 2.0 * off_m / settings.range_m, 0.0)

    def _with_fault(
        self, reading: RcReading, fault: SensorFault[RcReading], now_s: float
    ) -> RcReading | None:
        replace = msgspec.structs.replace
        match fault.kind:
            case "corrupt" if fault.random.random() >= fault.size:
                return reading
            case "garbage" | "corrupt":
                low_us, high_us = _GARBAGE_US
                noise = tuple([fault.random.randint(low_us, high_us) for _ in reading.channels_us])
                return replace(reading, channels_us=noise)
            case "wrong":
                preset = [1500] * len(reading.channels_us)
                preset[_THROTTLE : _THROTTLE + 1] = [round(fault.size)]
                return replace(reading, channels_us=tuple(preset))
            case "failsafe":
                return replace(reading, is_failsafe=True, quality=0.0)
            case _:
                return super()._with_fault(reading, fault, now_s)
