"""Encoder of ArduPilot's self-describing log format.

A record is A3 95, its type number, then its fields, little-endian and packed. FMT records define the types,
FMTU gives units and multipliers by letters, and UNIT and MULT define the letters (ArduPilot developer
documentation, "Understanding and modifying log messages").
"""

from collections.abc import Callable, Sequence
from functools import partial
from struct import Struct
from typing import Final

MAGIC: Final = (0xA3, 0x95)

_CODES: Final = {
    "b": "b", "B": "B", "h": "h", "H": "H", "i": "i", "I": "I", "q": "q", "Q": "Q", "f": "f", "d": "d",
    "n": "4s", "N": "16s", "Z": "64s",
    "c": "h", "C": "H", "e": "i", "E": "I",  # hundredths
    "L": "i",  # degrees × 1e7
    "M": "B",  # mode
}  # fmt: skip

UNITS: Final = {
    "-": "", "A": "A", "a": "Ah", "b": "B", "d": "deg", "D": "deglatitude", "G": "Gauss", "h": "degheading",
    "k": "deg/s", "m": "m", "n": "m/s", "o": "m/s/s", "O": "degC", "s": "s", "S": "satellites",
    "U": "deglongitude", "v": "V", "w": "Ohm", "X": "W.h", "Y": "us", "z": "Hz", "%": "%", "#": "instance",
}  # fmt: skip
MULTIPLIERS: Final = {
    "-": 0.0, "?": 1.0, "0": 1.0, "A": 1e-1, "B": 1e-2, "C": 1e-3, "F": 1e-6, "G": 1e-7
}  # fmt: skip


class RecordKind:
    """One type of record.

    codes: one letter per field, as in _CODES. units, multipliers: one letter per field, as in UNITS and
    MULTIPLIERS. `pack` takes the raw values in order and returns the record.

    Raises:
        ValueError: inconsistent, or too long for the FMT record; names the type.
        struct.error: (from `pack`) a value that does not fit its field.
    """

    __slots__ = ("codes", "columns", "multipliers", "name", "number", "pack", "size_bytes", "units")

    def __init__(
        self, number: int, name: str, codes: str, columns: str, units: str, multipliers: str
    ) -> None:
        count = len(columns.split(","))
        if not (len(codes) == count == len(units) == len(multipliers)):
            raise ValueError(f"log record {name}: codes, columns, units and multipliers differ in number")
        if len(name) > 4 or len(codes) > 16 or len(columns) > 64 or not 0 < number < 256:
            raise ValueError(f"log record {name}: too long for a FMT record")
        if set(units) - set(UNITS) or set(multipliers) - set(MULTIPLIERS):
            raise ValueError(f"log record {name}: a unit or multiplier that has no letter")
        layout = Struct("<3B" + "".join(_CODES[code] for code in codes))
        self.number = number
        self.name = name
        self.codes = codes
        self.columns = columns
        self.units = units
        self.multipliers = multipliers
        self.size_bytes = layout.size
        self.pack: Callable[..., bytes] = partial(layout.pack, *MAGIC, number)


FMT: Final = RecordKind(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns", "-b---", "-----")
UNIT: Final = RecordKind(129, "UNIT", "QbZ", "TimeUS,Id,Label", "s--", "F--")
MULT: Final = RecordKind(130, "MULT", "Qbd", "TimeUS,Id,Mult", "s--", "F--")
FMTU: Final = RecordKind(131, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", "s---", "F---")


def file_header(kinds: Sequence[RecordKind]) -> bytes:
    """The start of a log file: the definitions of all record types."""
    every = (FMT, UNIT, MULT, FMTU, *kinds)
    parts = [
        FMT.pack(k.number, k.size_bytes, k.name.encode(), k.codes.encode(), k.columns.encode()) for k in every
    ]
    parts += [UNIT.pack(0, ord(letter), label.encode()) for letter, label in UNITS.items()]
    parts += [MULT.pack(0, ord(letter), factor) for letter, factor in MULTIPLIERS.items()]
    parts += [FMTU.pack(0, k.number, k.units.encode(), k.multipliers.encode()) for k in every]
    return b"".join(parts)
