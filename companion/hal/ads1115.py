"""ADS1115 analog-to-digital converter on I²C, from its data sheet (Texas Instruments SBAS444E)."""

import threading
import time
from collections import defaultdict
from collections.abc import Callable
from typing import Final

from companion.core.errors import HardwareError
from companion.hal.raspberry_pi import I2cBus, Registers

ADDRESSES: Final = range(0x48, 0x4C)  # ADDR pin to ground, supply, SDA or SCL
_CONVERSION_AT, _CONFIG_AT = 0x00, 0x01  # 8.1.1
# 8.1.3: start one conversion (OS), input against ground (MUX), ±4.096 V, 32 samples a second, no comparator
_START: Final = 0x8000 | 0x4000 | 0b001 << 9 | 1 << 8 | 0b010 << 5 | 0b11
_CONVERSION_S: Final = 1.0 / 32.0
_LATE: Final = 1.2  # its clock is off by up to 10 %, 6.5
_POLL_S: Final = 0.005
_VOLT: Final = 4.096 / 32768.0
_FULL_SCALE: Final = 32767
# One conversion at a time: the battery monitor and probes may share a part, each in its thread
_LOCKS: Final[defaultdict[int, threading.Lock]] = defaultdict(threading.Lock)


class Ads1115:
    """One part at one bus address. A conversion averages the input over 31 ms."""

    def __init__(self, bus: I2cBus, address: int, pause: Callable[[float], None] = time.sleep) -> None:
        """pause: waits these seconds. Raises HardwareError: the part does not keep its configuration, so it
        is not an ADS1115; OSError: nothing answers.
        """
        self.bus = bus
        self._registers = Registers(bus, address)
        self._pause = pause
        with _LOCKS[address]:
            self._start(0)
            kept = self._registers.read_word(_CONFIG_AT)
        if kept & 0x7FFF != _START & 0x7FFF:
            raise HardwareError(f"ADS1115: the part at I²C address {address:#x} is not an ADS1115")

    def read_v(self, channel: int) -> float | None:
        """Voltage at an input, None at full scale. Takes 32 ms.
        Raises HardwareError: the conversion does not end; OSError: it does not answer.
        """
        with _LOCKS[self._registers.address]:
            return self._convert_v(channel)

    def _convert_v(self, channel: int) -> float | None:
        self._start(channel)
        waited_s = _CONVERSION_S
        self._pause(_CONVERSION_S)
        while not self._registers.read_word(_CONFIG_AT) & 0x8000:
            if waited_s > _LATE * _CONVERSION_S:
                raise HardwareError("ADS1115: a conversion does not end")
            self._pause(_POLL_S)
            waited_s += _POLL_S
        steps = self._registers.read_word(_CONVERSION_AT)
        steps -= 0x10000 if steps & 0x8000 else 0
        return None if abs(steps) >= _FULL_SCALE else steps * _VOLT

    def _start(self, channel: int) -> None:
        self._registers.write(_CONFIG_AT, *(_START | channel << 12).to_bytes(2, "big"))
