"""The registers of a PCA9685, from its data sheet (NXP PCA9685, Rev. 4, 16 April 2015)."""

import time
from typing import Final

from companion.config.actuators import Pca9685Part
from companion.core.errors import HardwareError
from companion.hal.raspberry_pi import I2cBus, Registers

MODE1: Final = 0x00
MODE2: Final = 0x01
LED0: Final = 0x06  # four bytes a channel: ON low and high, OFF low and high
ALL_LED_OFF_H: Final = 0xFD
PRE_SCALE: Final = 0xFE
SLEEP: Final = 0x10
AUTO_INCREMENT: Final = 0x20
TOTEM_POLE: Final = 0x04  # MODE2: outputs change on the stop condition, and are low while OE is high
FULL_OFF: Final = 0x10  # in OFF high; wins over everything else (7.3.3)
_STEPS: Final = 4096
AT_ONCE: Final = 8  # channels in a block of SMBus, 32 bytes
_OSCILLATOR_STARTS_S: Final = 0.0005  # 7.3.1.1


class Pca9685:
    """Registers of the chip at one bus address."""

    def __init__(self, bus: I2cBus, part: Pca9685Part, *, sets_up: bool = True) -> None:
        """sets_up: False leaves the chip as it is. Raises HardwareError: the part does not keep its
        registers, so it is not a PCA9685; OSError: it does not answer.
        """
        self.bus = bus
        self._registers = Registers(bus, part.address)
        self._pre_scale = pre_scale(part.oscillator_hz, part.frequency_hz)
        self._step_us = 1e6 * (self._pre_scale + 1) / part.oscillator_hz
        if sets_up:
            self.set_up()
        if sets_up and not self.is_set_up():
            raise HardwareError(f"PCA9685: the part at I²C address {part.address:#x} is not a PCA9685")

    def set_up(self) -> None:
        """All channels off, the frequency, and awake. PRE_SCALE can be written only in sleep (7.3.5); a chip
        that has the frequency goes on running.
        """
        self.all_off()
        if self._registers.read(PRE_SCALE, 1)[0] != self._pre_scale:
            self._registers.write(MODE1, SLEEP | AUTO_INCREMENT)
            self._registers.write(PRE_SCALE, self._pre_scale)
        self._registers.write(MODE2, TOTEM_POLE)
        self._registers.write(MODE1, AUTO_INCREMENT)
        time.sleep(_OSCILLATOR_STARTS_S)

    def is_set_up(self) -> bool:
        """False after a dip of its supply, which puts it to sleep with all channels off (7.3.1, table 4)."""
        expected = ((MODE1, AUTO_INCREMENT), (MODE2, TOTEM_POLE), (PRE_SCALE, self._pre_scale))
        return all(self._registers.read(register, 1)[0] == value for register, value in expected)

    def steps(self, width_us: float) -> int:
        """A width in the chip's steps."""
        return min(round(width_us / self._step_us), _STEPS - 1)

    def write(self, channel: int, *widths: int) -> None:
        """Pulses of these widths, in steps, on a channel and those after it, at most eight; 0 for none."""
        data: list[int] = []
        for steps in widths:
            data += (0, 0, steps & 0xFF, steps >> 8) if steps else (0, 0, 0, FULL_OFF)
        self._registers.write(LED0 + 4 * channel, *data)

    def all_off(self) -> None:
        """No pulses on any channel."""
        self._registers.write(ALL_LED_OFF_H, FULL_OFF)


def pre_scale(oscillator_hz: float, frequency_hz: float) -> int:
    """Equation 1 of the data sheet (7.3.5)."""
    return round(oscillator_hz / (_STEPS * frequency_hz)) - 1
