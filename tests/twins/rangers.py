"""Twins of rangers on serial lines: the bytes that they send, by their data sheets."""


def a02yyuw_frame(millimetres: int) -> bytes:
    """DFRobot SEN0311: 0xFF, high byte, low byte, low byte of the sum of the three."""
    high, low = millimetres >> 8, millimetres & 0xFF
    return bytes([0xFF, high, low, (0xFF + high + low) & 0xFF])


def tfmini_frame(centimetres: int, strength: int = 1000, celsius: float = 40.0) -> bytes:
    """Benewake SJ-PM-TFmini-S A00, 5.3: header, distance, strength, temperature, sum; low bytes first."""
    temperature = round((celsius + 256.0) * 8.0)
    frame = bytes([0x59, 0x59])
    for value in (centimetres, strength, temperature):
        frame += (value & 0xFFFF).to_bytes(2, "little")
    return frame + bytes([sum(frame) & 0xFF])
