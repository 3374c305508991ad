"""Configuration of servo signals: what makes the pulses, and their widths."""

import math
from typing import Annotated, Literal

from msgspec import Meta

from companion.config.board import I2cBus, OptionalPin
from companion.config.section import Section
from companion.core.units import clamp

PulseWidth = Annotated[int, Meta(ge=500, le=2500)]


class PulseOutputSetting(Section, frozen=True):
    """The signal of one servo or ESC.

    output: "hardware", the Pi's own PWM on GPIO 12, 13, 18 or 19; "software", lgpio on any pin, with the
    jitter of the scheduler; or "pca9685", a channel of that chip, whose frequency is set in [parts.pca9685].
    trim_us is the pulse of zero: centre, or stop. Equal to min_us it stands for an ESC without reverse.
    """

    output: Literal["hardware", "software", "pca9685"] = "hardware"
    pin: OptionalPin = -1  # BCM number, for "hardware" and "software"
    channel: Annotated[int, Meta(ge=0, le=15)] = 0  # of the PCA9685
    frequency_hz: Annotated[int, Meta(ge=50, le=400)] = 50  # analogue servos take 50 only
    min_us: PulseWidth = 1100
    trim_us: PulseWidth = 1500
    max_us: PulseWidth = 1900
    reversed: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.min_us <= self.trim_us <= self.max_us or self.min_us == self.max_us:
            raise ValueError(
                f"expected min_us ≤ trim_us ≤ max_us, got {self.min_us}, {self.trim_us}, {self.max_us}"
            )
        if self.max_us >= 1e6 / self.frequency_hz:
            raise ValueError(
                f"max_us = {self.max_us}: expected less than the period of {self.frequency_hz} Hz"
            )

    def width_us(self, share: float) -> float:
        """Width for a share of full travel, −1 to 1; trim_us for a value that is not finite."""
        if not math.isfinite(share):
            return self.trim_us
        share = clamp(-share if self.reversed else share, -1.0, 1.0)
        return self.trim_us + share * (
            self.max_us - self.trim_us if share > 0.0 else self.trim_us - self.min_us
        )

    def limited_us(self, width_us: float) -> float:
        """The nearest width that the part may get; trim_us for a value that is not finite."""
        return clamp(width_us, self.min_us, self.max_us) if math.isfinite(width_us) else self.trim_us


class Pca9685Part(Section, frozen=True):
    """A PCA9685 with 16 servo signals.

    Boards leave the factory with address 0x40, that of the INA219; with A0 bridged it is 0x41. oscillator_hz:
    25 MHz is typical; boards differ by some percent, and pulses with them. Measure a pulse, or put the error
    into trim_us. output_enable: the pin at OE, low while the program runs; with a resistor to 3.3 V the
    signals end when the Pi is reset, which does not reset the chip. −1: OE is wired to ground.
    """

    address: Annotated[int, Meta(ge=0x40, le=0x7F)] = 0x41
    frequency_hz: Annotated[int, Meta(ge=50, le=400)] = 50
    oscillator_hz: Annotated[float, Meta(ge=20e6, le=30e6)] = 25e6
    output_enable: OptionalPin = -1
    i2c_bus: I2cBus = 1
