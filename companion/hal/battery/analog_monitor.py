"""Pack voltage by a resistive divider and current by a Hall sensor (ACS712, ACS758), on an ADS1115."""

from typing import Final

from companion.config.parts.battery import BatteryPart
from companion.core.errors import HardwareError
from companion.hal.ads1115 import Ads1115
from companion.hal.battery.shunt_monitor import Measurement

# Without a current a Hall sensor gives half its supply, one for a single direction 0.12 of it: 0.39 V at
# 3.3 V. An input below this is a broken wire, or a sensor without its supply
_LEAST_HALL_V: Final = 0.1


class AnalogMonitor:
    """Two inputs of the converter."""

    def __init__(self, converter: Ads1115, part: BatteryPart) -> None:
        self.bus = converter.bus
        self._converter = converter
        self._part = part

    def read(self) -> Measurement:
        """One conversion of each input. The current is None without a sensor, or beyond the input's range.

        Raises:
            HardwareError: the pack's voltage is beyond the divider's range, or the converter hangs.
            OSError: it does not answer.
        """
        part = self._part
        input_v = self._converter.read_v(part.voltage_channel)
        if input_v is None:
            raise HardwareError("ADS1115: the divider's voltage is beyond the input's range")
        current_a = None
        if part.current_channel >= 0:
            hall_v = self._converter.read_v(part.current_channel)
            if hall_v is not None and hall_v >= _LEAST_HALL_V:
                current_a = (hall_v - part.zero_v) / part.volt_per_a
        return Measurement(input_v * part.divider, current_a)
