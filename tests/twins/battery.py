"""Twins of the battery monitors, register by register as their data sheets have them."""

import struct
from collections.abc import Callable


def signed(volt: float, step_v: float, limit: int) -> int:
    """A measurement in steps, as the converter clips it."""
    return min(max(round(volt / step_v), -limit - 1), limit)


class MonitorTwin:
    """What the three shunt monitors share: registers that hold nothing until the part has measured.

    pack_v is the voltage at Vin+. is_stuck: it goes on answering with what it measured last.
    """

    def __init__(self, now: Callable[[], float]) -> None:
        self.pack_v, self.shunt_v = 11.15, 0.15
        self._now = now
        self.power_up()

    def power_up(self) -> None:
        """As its supply comes on, or after a dip."""
        self._since_s = self._now()
        self.reset()

    def reset(self) -> None:
        """Registers as the data sheet's power-on defaults."""
        raise NotImplementedError

    def begin(self) -> None:
        """A new configuration begins a new average."""
        self._since_s = self._now()

    def get(self, register: int, length: int) -> bytes:
        raise NotImplementedError

    def put(self, register: int, data: bytes) -> None:
        raise NotImplementedError

    def average_s(self) -> float:
        """Time of one average of shunt and bus, by the configuration; slower by 10 % than typical."""
        raise NotImplementedError

    @property
    def has_measured(self) -> bool:
        assert 0.02 < self.average_s() < 0.09, "averages many periods of the PWM, and is done in time"
        return self._now() - self._since_s >= self.average_s()


class Ina219Twin(MonitorTwin):
    """SBOS448G: six registers of two bytes, the higher one first."""

    def reset(self) -> None:
        self.configuration = 0x399F

    def average_s(self) -> float:
        """Table 5: with bit 3 of the four, samples of 532 µs."""
        both = (self.configuration >> 7 & 0xF, self.configuration >> 3 & 0xF)
        return 1.1 * sum(532e-6 * 2 ** (one & 7) if one & 8 else 532e-6 for one in both)

    def get(self, register: int, length: int) -> bytes:
        assert length == 2
        if register == 0:
            return struct.pack(">H", self.configuration)
        assert self.configuration & 0x1800 == 0x1800, "±320 mV"
        assert self.configuration & 0x0007 == 0x0007, "it does not measure"
        if not self.has_measured or register not in (1, 2):
            return bytes(2)
        if register == 1:
            return struct.pack(">h", min(max(round(self.shunt_v / 10e-6), -32000), 32000))
        bus_v = self.pack_v - self.shunt_v  # it measures at Vin−
        return struct.pack(">H", round(bus_v / 4e-3) << 3 | 0x2)  # CNVR: there is a new value

    def put(self, register: int, data: bytes) -> None:
        (value,) = struct.unpack(">H", data)
        if register == 0:
            self.configuration = value
            self.begin()


class Ina226Twin(MonitorTwin):
    """SBOS547A. VBUS has a pin of its own, which is wired to the pack."""

    die_id = 0x2260

    def reset(self) -> None:
        self.configuration = 0x4127

    def average_s(self) -> float:
        """Tables 6 to 8."""
        times_us = (140, 204, 332, 588, 1100, 2116, 4156, 8244)
        pair_us = times_us[self.configuration >> 6 & 7] + times_us[self.configuration >> 3 & 7]
        averages = (1, 4, 16, 64, 128, 256, 512, 1024)[self.configuration >> 9 & 7]
        return 1.1e-6 * averages * pair_us

    def get(self, register: int, length: int) -> bytes:
        assert length == 2
        match register:
            case 0x00:
                return struct.pack(">H", self.configuration)
            case 0x01 | 0x02 if not self.has_measured:
                return bytes(2)
            case 0x01:
                assert self.configuration & 7 == 7, "shunt and bus, continuous"
                return struct.pack(">h", signed(self.shunt_v, 2.5e-6, 0x7FFF))
            case 0x02:
                return struct.pack(">H", min(round(self.pack_v / 1.25e-3), 0x7FFF))
            case 0xFE:
                return b"TI"
            case 0xFF:
                return struct.pack(">H", self.die_id)
            case _:  # current and power need a calibration
                return bytes(2)

    def put(self, register: int, data: bytes) -> None:
        (value,) = struct.unpack(">H", data)
        if register == 0x00:
            self.configuration = value & 0x8FFF | 0x4000  # bits 14 to 12 are fixed
            self.begin()


class Ina228Twin(MonitorTwin):
    """SBOSA20A: results of 20 bits above four that are always 0, in three bytes."""

    device_id = 0x2281

    def reset(self) -> None:
        self.config, self.adc_config = 0x0000, 0xFB68

    def average_s(self) -> float:
        """Table 7-6: bus, shunt and, where it is measured, the temperature."""
        times_us = (50, 84, 150, 280, 540, 1052, 2074, 4120)
        shifts = (9, 6, 3) if self.adc_config >> 12 & 4 else (9, 6)
        one_us = sum(times_us[self.adc_config >> shift & 7] for shift in shifts)
        return 1.1e-6 * (1, 4, 16, 64, 128, 256, 512, 1024)[self.adc_config & 7] * one_us

    def get(self, register: int, length: int) -> bytes:
        assert length == (3 if register in (0x04, 0x05, 0x07, 0x08) else 2)
        match register:
            case 0x00:
                return struct.pack(">H", self.config)
            case 0x01:
                return struct.pack(">H", self.adc_config)
            case 0x04 | 0x05 if not self.has_measured:
                return bytes(3)
            case 0x04:
                assert self.adc_config >> 12 & 0x3 == 0x3, "shunt and bus"
                step_v = 78.125e-9 if self.config & 0x10 else 312.5e-9
                return (signed(self.shunt_v, step_v, 0x7FFFF) << 4).to_bytes(3, "big", signed=True)
            case 0x05:
                return (round(self.pack_v / 195.3125e-6) << 4).to_bytes(3, "big")
            case 0x3E:
                return b"TI"
            case 0x3F:
                return struct.pack(">H", self.device_id)
            case _:
                return bytes(length)

    def put(self, register: int, data: bytes) -> None:
        (value,) = struct.unpack(">H", data)
        match register:
            case 0x00:
                self.config = value
                self.begin()
            case 0x01:
                self.adc_config = value
                self.begin()


class Ads1115Twin:
    """SBAS444E: one converter behind a multiplexer of four inputs.

    inputs_v: against ground; an input cannot exceed the supply. is_hung: conversions never end.
    """

    RATES = (8, 16, 32, 64, 128, 250, 475, 860)
    RANGES_V = (6.144, 4.096, 2.048, 1.024, 0.512, 0.256, 0.256, 0.256)

    def __init__(self, now: Callable[[], float]) -> None:
        self.inputs_v = [0.0, 0.0, 0.0, 0.0]
        self.supply_v = 3.3
        self.slow = 1.1  # its clock is off by up to 10 %
        self.is_hung = False
        self._now = now
        self.power_up()

    def power_up(self) -> None:
        """As its supply comes on, or after a dip."""
        self.config, self.result = 0x8583, 0
        self._ends_s = -1.0

    def get(self, register: int, length: int) -> bytes:
        assert length == 2
        is_busy = self.is_hung or self._now() < self._ends_s
        match register:
            case 0x00:
                return struct.pack(">h", self.result if is_busy else self._convert())
            case 0x01:
                return struct.pack(">H", self.config & 0x7FFF | (0 if is_busy else 0x8000))
            case _:
                return b"\x80\x00" if register == 0x02 else b"\x7f\xff"

    def put(self, register: int, data: bytes) -> None:
        if register == 0x01:
            (self.config,) = struct.unpack(">H", data)
            assert self.config & 0x0100, "single-shot: else OS means nothing"
            assert self.config & 0x001F == 0x0003, "no comparator"
            if self.config & 0x8000:
                self._ends_s = self._now() + self.slow / self.RATES[self.config >> 5 & 7]

    def _convert(self) -> int:
        assert self.config & 0x4000, "against ground"
        input_v = min(self.inputs_v[self.config >> 12 & 3], self.supply_v + 0.3)
        range_v = self.RANGES_V[self.config >> 9 & 7]
        self.result = min(max(round(input_v / range_v * 32768), -32768), 32767)
        return self.result
