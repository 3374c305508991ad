"""What speed controllers send over serial lines. Pure; never raises.

KISS: ten bytes by themselves or on request, without a header, as KISS, T-Motor, BLHeli_32 and AM32 send them
(`makeTelemPackage` of AM32, `esc_sensor.c` of Betaflight): temperature in °C, voltage in 10 mV, current in
10 mA, charge in mAh, electrical turns a minute in hundreds, CRC-8 with the polynomial 0x07.

VESC: 2, the payload's length, the payload, its CRC-16/XMODEM, 3 (`packet.c`); values are as in `commands.c`
of the firmware since 3.34. Longer packets, which begin with 3, are not asked for, and skipped.
"""

import math
from abc import abstractmethod
from itertools import count
from struct import Struct
from typing import Final

from fastcrc.crc8 import smbus as crc8
from fastcrc.crc16 import xmodem as crc16

from companion.core.readings import EscReading
from companion.sensors.framing import FrameReader

GET_VALUES, SET_DUTY, SET_CURRENT, FORWARD_CAN = 4, 5, 6, 34
_KISS: Final = Struct(">bHHHHx")
# Temperatures of switches and motor, currents of motor and pack, two unused, duty, speed, voltage, charge,
# five unused, fault, position, number on CAN
_VALUES: Final = Struct(">hhii8xhihi20xB4xB")
_SHORT, _END = 2, 3
_FRAMING_BYTES: Final = 5
_NO_SENSOR_C: Final = -40.0  # a motor without a thermistor reads less
_FAULTS: Final = {  # mc_fault_code
    1: "overvoltage",
    2: "undervoltage",
    3: "gate driver fault",
    4: "overcurrent",
    5: "hot switches",
    6: "hot motor",
}

Readings = tuple[EscReading, ...]


class EscParser(FrameReader):
    """The latest reading of each controller on a line. pause_s: longer ones end a frame.

    side: of the controller on the line. can_id: of a right one that answers over it; −1: none does.
    """

    pause_s = math.inf

    def __init__(self, side: int, pole_pairs: int, can_id: int = -1) -> None:
        super().__init__()
        self._side, self._can_id = side, can_id
        self._rad_s = math.tau / 60.0 / pole_pairs  # of the shaft, at an electrical turn a minute
        self._latest: dict[int, EscReading] = {}
        self._counts = count(1), count(1)
        self._heard_s = -math.inf

    def feed(self, data: bytes, time_s: float) -> Readings | None:
        """Parse more bytes. None before the first reading."""
        if time_s - self._heard_s > self.pause_s:
            self.forget()
        self._heard_s = time_s
        for frame in self.split(data):
            if (reading := self._reading(frame, time_s)) is not None:
                self._latest[reading.side] = reading
        return tuple(self._latest.values()) or None

    @abstractmethod
    def _reading(self, frame: bytes, time_s: float) -> EscReading | None:
        """The reading of a good frame; None without values."""


class KissParser(EscParser):
    """Frames of KISS. Zeros, as of a broken line, have a right CRC: a frame without a voltage is none."""

    pause_s = 0.01  # a frame takes 0.9 ms; the next comes 30 ms after it

    def _size(self, held: bytes, at: int) -> int:  # noqa: ARG002 (they have no header)
        return _KISS.size

    def _is_whole(self, frame: bytes) -> bool:
        return crc8(frame[:-1]) == frame[-1] and any(frame[1:3])

    def _reading(self, frame: bytes, time_s: float) -> EscReading:
        celsius, voltage, current, charge, speed = _KISS.unpack(frame)
        return EscReading(
            time_s, self._side, next(self._counts[self._side]), self._rad_s * 100.0 * speed,
            0.01 * voltage, 0.01 * current, celsius, charge,
        )  # fmt: skip


class VescParser(EscParser):
    """Short packets of VESCs."""

    def _size(self, held: bytes, at: int) -> int:
        if held[at] != _SHORT:
            return 0
        if at + 1 == len(held):
            return 2
        return held[at + 1] + _FRAMING_BYTES if held[at + 1] else 0

    def _is_whole(self, frame: bytes) -> bool:
        return frame[-1] == _END and crc16(frame[2:-3]) == int.from_bytes(frame[-3:-1], "big")

    def _reading(self, frame: bytes, time_s: float) -> EscReading | None:
        if frame[2] != GET_VALUES or len(frame) < _FRAMING_BYTES + 1 + _VALUES.size:
            return None
        fets, motor, _, current, _, erpm, voltage, charge, fault, number = _VALUES.unpack_from(frame, 3)
        side = 1 if 0 <= self._can_id == number else self._side
        return EscReading(
            time_s, side, next(self._counts[side]), self._rad_s * erpm,
            0.1 * voltage, 0.01 * current, 0.1 * fets, 0.1 * charge,
            0.1 * motor if 0.1 * motor > _NO_SENSOR_C else None,
            _FAULTS.get(fault, f"fault {fault}") if fault else "",
        )  # fmt: skip


def vesc_packet(command: int, value: int | None = None, can_id: int = -1) -> bytes:
    """A command with a value of 32 bits, if it has one. can_id: of the VESC to pass it on to; −1: none."""
    payload = bytes((command,)) if can_id < 0 else bytes((FORWARD_CAN, can_id, command))
    if value is not None:
        payload += value.to_bytes(4, "big", signed=True)
    return bytes((_SHORT, len(payload))) + payload + crc16(payload).to_bytes(2, "big") + bytes((_END,))
