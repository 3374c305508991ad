"""A rudder turned by a servo."""

from companion.config.parts import PulseOutputSetting
from companion.hal.interfaces import PulseOutput


class RudderServo:
    """Satisfies `companion.hal.interfaces.Rudder`. Amidships from the start; without pulses once closed."""

    def __init__(self, output: PulseOutput, setting: PulseOutputSetting) -> None:
        self._output = output
        self._setting = setting
        self.write(0.0)

    def write(self, share: float) -> None:
        """Turn to a share of full travel, −1 to 1, limited; amidships for a value that is not finite.

        Raises:
            HardwareError: closed, or the signal failed.
        """
        self._output.write_us(self._setting.width_us(share))

    def close(self) -> None:
        """No more pulses. May be called twice."""
        self._output.close()
