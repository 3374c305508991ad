"""Servo pulses by lgpio in software, on any pin.

A thread of lgpio switches the pin, when the scheduler lets it: "the timing jitter will cause the servo to
fidget. This may cause it to overheat and wear out prematurely" (lgpio's documentation of tx_servo). It ends
with the process; the pin then keeps its last level, since the kernel of the Pi leaves a released output as it
is (pinctrl-bcm2835, persist_gpio_outputs).
"""

import contextlib
import time
from collections.abc import Callable
from types import ModuleType

from companion.config.actuators import PulseOutputSetting
from companion.core.errors import HardwareError
from companion.hal.raspberry_pi import import_optional

_LABELS = ("pinctrl-rp1", "pinctrl-bcm2711", "pinctrl-bcm2835")  # of the chip with the header's pins
_CHIPS = 16
_PERIODS = 4  # the pulses under way end within two


class LgpioPulses:
    """Satisfies `companion.hal.interfaces.PulseOutput` with one pin of lgpio."""

    def __init__(
        self,
        lgpio: ModuleType,
        handle: int,
        setting: PulseOutputSetting,
        wait: Callable[[float], None] = time.sleep,
    ) -> None:
        self._lgpio = lgpio
        self._handle = handle
        self._setting = setting
        self._wait = wait
        self._width_us = 0  # 0: no pulses
        lgpio.gpio_claim_output(handle, setting.pin, 0)

    def write_us(self, width_us: float) -> None:
        """Send pulses of this width, limited to the setting's, after the one under way.
        Raises HardwareError: closed, or lgpio refused.
        """
        whole_us = round(self._setting.limited_us(width_us))
        if self._handle < 0:
            raise HardwareError(f"GPIO {self._setting.pin}: written to after close")
        if whole_us != self._width_us:
            self._send(whole_us, 0)
            self._width_us = whole_us

    def off(self) -> None:
        """One more pulse, then none, and the pin low: a pulse cut short would be another command.
        Raises HardwareError: lgpio refused.
        """
        if self._handle >= 0 and self._width_us:
            self._send(self._width_us, 1)
            self._width_us = 0

    def close(self) -> None:
        """No more pulses, then release the pin once the last has ended. May be called twice."""
        if self._handle < 0:
            return
        try:
            self.off()
            for _ in range(_PERIODS):
                if not self._lgpio.tx_busy(self._handle, self._setting.pin, self._lgpio.TX_PWM):
                    break
                self._wait(1.0 / self._setting.frequency_hz)
        finally:
            handle, self._handle = self._handle, -1
            self._lgpio.gpiochip_close(handle)

    def _send(self, width_us: int, cycles: int) -> None:
        try:
            self._lgpio.tx_servo(
                self._handle, self._setting.pin, width_us, self._setting.frequency_hz, 0, cycles
            )
        except self._lgpio.error as error:
            raise HardwareError(f"GPIO {self._setting.pin}: {error}") from error


def open_lgpio_pulses(setting: PulseOutputSetting) -> LgpioPulses:
    """Open the setting's pin, low and without pulses.
    Raises HardwareError: lgpio is missing, there are no pins, or this one is in use.
    """
    part = f"GPIO {setting.pin}"
    lgpio = import_optional("lgpio", part)
    handle = _open_header(lgpio, part)
    try:
        return LgpioPulses(lgpio, handle, setting)
    except lgpio.error as error:
        lgpio.gpiochip_close(handle)
        raise HardwareError(f"{part}: the pin cannot be used: {error}") from error


def _open_header(lgpio: ModuleType, part: str) -> int:
    reason = "no chip has the pins of a Pi"
    for number in range(_CHIPS):
        try:
            handle: int = lgpio.gpiochip_open(number)
        except lgpio.error as error:
            if number == 0:
                reason = str(error)
            continue
        if lgpio.gpio_get_chip_info(handle)[3] in _LABELS:
            return handle
        with contextlib.suppress(lgpio.error):
            lgpio.gpiochip_close(handle)
    raise HardwareError(f"{part}: the pins cannot be opened: {reason}; add the user to the group gpio")
