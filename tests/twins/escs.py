"""Twins of speed controllers that report over serial lines, written from what runs in them.

KISS: AM32's `kiss_telemetry.c` (order and scale of the fields, high byte first; the temperature is an int8),
`get_crc8` as Betaflight's `esc_sensor.c` and the KISS sheet have it bit by bit, and the pace of AM32's
`tenKhzRoutine`: a frame every 30 ms while `telemetry_on_interval` is set, whatever the pulses are.

VESC: bldc's `packet.c` (framing, and what its receiver refuses), `commands.c` (which commands reset the
timeout, the fields of COMM_GET_VALUES, COMM_FORWARD_CAN), `timeout.c` and APPCONF_TIMEOUT_MSEC of 1000.
PyVESC has the same fields and scales, and CrcXmodem.
"""

import struct

from twins.lines import HandClock


def kiss_crc(data: bytes) -> int:
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (0x07 ^ (crc << 1) if crc & 0x80 else crc << 1) & 0xFF
    return crc


def kiss_frame(celsius: int, centivolts: int, centiamps: int, mah: int, hundreds_erpm: int) -> bytes:
    """As `makeTelemPackage`."""
    words = (centivolts, centiamps, mah, hundreds_erpm)
    frame = bytes((celsius & 0xFF,)) + b"".join(bytes((word >> 8, word & 0xFF)) for word in words)
    return frame + bytes((kiss_crc(frame),))


def vesc_crc(data: bytes) -> int:
    """`crc16`, by its polynomial 0x1021 instead of its table."""
    crc = 0
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (0x1021 ^ (crc << 1) if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def vesc_frame(payload: bytes) -> bytes:
    """As `packet_send_packet`: a length of two bytes from 256 on."""
    head = bytes((2, len(payload))) if len(payload) < 256 else b"\x03" + struct.pack(">H", len(payload))
    return head + payload + struct.pack(">H", vesc_crc(payload)) + b"\x03"


class VescTwin:
    """One VESC, and one behind it on CAN. duty: what its motor gets; 0 coasts."""

    def __init__(self, clock: HandClock, number: int = 10, behind: "VescTwin | None" = None) -> None:
        self.number = number
        self.behind = behind
        self.duty = self.current_a = 0.0
        self.erpm, self.volts, self.amps, self.mah = 12340, 15.2, 3.21, 456.7
        self.fet_c, self.motor_c, self.fault = 41.5, 38.2, 0
        self.refused = 0
        self._clock = clock
        self._reset_s = clock()
        self._held = b""

    def hear(self, data: bytes) -> bytes:
        """Take bytes; the answers."""
        self._held += data
        answers = b""
        while self._held:
            if self._held[0] != 2 or len(self._held) < 2:
                self._held, self.refused = self._held[1:], self.refused + 1
                continue
            size = self._held[1] + 5
            frame, self._held = self._held[:size], self._held[size:]
            payload = frame[2:-3]
            if frame[-1] != 3 or vesc_crc(payload) != int.from_bytes(frame[-3:-1], "big"):
                self.refused += 1
                continue
            answers += self._process(payload)
        return answers

    def _process(self, payload: bytes) -> bytes:
        command, data = payload[0], payload[1:]
        match command:
            case 4:
                return vesc_frame(self.values())
            case 5:
                (value,) = struct.unpack(">i", data)
                self.duty, self.current_a, self._reset_s = value / 100_000.0, 0.0, self._clock()
            case 6:
                (value,) = struct.unpack(">i", data)
                self.duty, self.current_a, self._reset_s = 0.0, value / 1000.0, self._clock()
            case 34 if self.behind is not None and data[0] == self.behind.number:
                return self.behind._process(data[1:])
        return b""

    def tick(self) -> None:
        """`timeout_thread`: releases the motor."""
        for vesc in filter(None, (self, self.behind)):
            if self._clock() - vesc._reset_s > 1.0:
                vesc.duty = vesc.current_a = 0.0

    def values(self) -> bytes:
        return (
            b"\x04"
            + struct.pack(">hh", round(self.fet_c * 10), round(self.motor_c * 10))
            + struct.pack(">iiii", round(self.amps * 150), round(self.amps * 100), 0, round(self.amps * 150))
            + struct.pack(">hih", round(self.duty * 1000), self.erpm, round(self.volts * 10))
            + struct.pack(">iiii", round(self.mah * 10), 0, round(self.mah * 152), 0)
            + struct.pack(">ii", -4000, 120000)
            + struct.pack(">Bi", self.fault, 0)
            + bytes((self.number,))
            + struct.pack(">hhhii", 400, 410, 415, 100, 2200)
            + b"\x00"
        )
