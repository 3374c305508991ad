"""What speed controllers send over serial lines. Pure; never raises.

KISS: ten bytes by themselves or on request, without a header, as KISS, T-Motor, BLHeli_32 and AM32 send them
(`makeTelemPackage` of AM32, `esc_sensor.c` of Betaflight): temperature in °C, voltage in 10 mV, current in
10 mA, charge in mAh, electrical turns a minute in hundreds, CRC-8 with the polynomial 0x07.

VESC: 2, the payload's length, the payload, its CRC-16/XMODEM, 3 (`packet.c`); values are as in `commands.c`
of the firmware since 3.34. Longer packets, which begin with 3, are not asked for, and skipped.
"""

from struct import Struct
from typing import Final, NamedTuple

from fastcrc.crc8 import smbus as crc8
from fastcrc.crc16 import xmodem as crc16

from companion.sensors.framing import FrameReader

GET_VALUES, SET_DUTY, SET_CURRENT, FORWARD_CAN = 4, 5, 6, 34
_KISS: Final = Struct(">bHHHH")
_KISS_BYTES: Final = 10
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


class EscValues(NamedTuple):
    """One report. erpm: electrical turns a minute. number: on the CAN bus."""

    erpm: float
    voltage_v: float
    current_a: float
    temperature_c: float
    consumed_mah: float
    motor_c: float | None = None
    fault: str = ""
    number: int | None = None


class KissReader(FrameReader):
    """Frames of KISS. Zeros, as of a broken line, have a right CRC: a frame without a voltage is none."""

    def _size(self, held: bytes, at: int) -> int:  # noqa: ARG002 (they have no header)
        return _KISS_BYTES

    def _is_whole(self, frame: bytes) -> bool:
        return crc8(frame[:-1]) == frame[-1] and any(frame[1:3])


def kiss_values(frame: bytes) -> EscValues:
    celsius, voltage, current, charge, speed = _KISS.unpack_from(frame)
    return EscValues(100.0 * speed, 0.01 * voltage, 0.01 * current, celsius, charge)


class VescReader(FrameReader):
    """Short packets of a VESC."""

    def _size(self, held: bytes, at: int) -> int:
        if held[at] != _SHORT:
            return 0
        if at + 1 == len(held):
            return 2
        return held[at + 1] + _FRAMING_BYTES if held[at + 1] else 0

    def _is_whole(self, frame: bytes) -> bool:
        return frame[-1] == _END and crc16(frame[2:-3]) == int.from_bytes(frame[-3:-1], "big")


def vesc_values(frame: bytes) -> EscValues | None:
    """None for another answer than that to GET_VALUES."""
    if frame[2] != GET_VALUES or len(frame) < _FRAMING_BYTES + 1 + _VALUES.size:
        return None
    fets, motor, _, current, _, erpm, voltage, charge, fault, number = _VALUES.unpack_from(frame, 3)
    return EscValues(
        erpm, 0.1 * voltage, 0.01 * current, 0.1 * fets, 0.1 * charge,
        0.1 * motor if 0.1 * motor > _NO_SENSOR_C else None,
        _FAULTS.get(fault, f"fault {fault}") if fault else "", number,
    )  # fmt: skip


def vesc_packet(command: int, value: int | None = None, can_id: int = -1) -> bytes:
    """A command with a value of 32 bits, if it has one. can_id: of the VESC to pass it on to; −1: none."""
    payload = bytes((command,)) if can_id < 0 else bytes((FORWARD_CAN, can_id, command))
    if value is not None:
        payload += value.to_bytes(4, "big", signed=True)
    return bytes((_SHORT, len(payload))) + payload + crc16(payload).to_bytes(2, "big") + bytes((_END,))
