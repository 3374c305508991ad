"""Opens a servo signal, whatever makes it; a rudder on one."""

from companion.config.actuators import Pca9685Part, PulseOutputSetting
from companion.hal.interfaces import PulseOutput
from companion.hal.pulses.lgpio_pulses import open_lgpio_pulses
from companion.hal.pulses.pca9685 import open_pca9685_pulses
from companion.hal.pulses.sysfs_pwm import open_sysfs_pulses


def open_pulse_output(setting: PulseOutputSetting, chip: Pca9685Part) -> PulseOutput:
    """Open a servo signal, without pulses until the first write.
    Raises HardwareError: it cannot be opened; the message says what to do.
    """
    match setting.output:
        case "hardware":
            return open_sysfs_pulses(setting)
        case "software":
            return open_lgpio_pulses(setting)
        case "pca9685":
            return open_pca9685_pulses(setting, chip)


class RudderServo:
    """Satisfies `companion.hal.interfaces.Rudder`. Amidships from the start; without pulses once closed."""

    def __init__(self, output: PulseOutput, setting: PulseOutputSetting) -> None:
        self._output = output
        self._setting = setting
        self.write(0.0)

    def write(self, share: float) -> None:
        """Turn to a share of full travel, −1 to 1, limited; amidships for a value that is not finite.
        Raises HardwareError: closed, or the signal failed.
        """
        self._output.write_us(self._setting.width_us(share))

    def close(self) -> None:
        self._output.close()
