"""Values of parameters as the wire carries them.

ArduPilot, and mavboat as it does, casts every value to a 32-bit float. PX4 puts the bytes of whole
numbers into the float's place ("Parameter Protocol" of the MAVLink guide: C-style cast, bytewise).
"""

import math
import re
import struct
from typing import Final, NamedTuple

from companion.core.units import as_float32, shortest
from companion.mavlink.dialect import Message
from mission_tools.station.words import say

REAL32: Final = 9  # MAV_PARAM_TYPE_REAL32
NAME: Final = re.compile(r"[!-~]{1,16}")  # what can be shown and sent back
_MOST_EXACT: Final = 1 << 24  # whole numbers up to here are 32-bit floats


class _Kind(NamedTuple):
    """code: of struct, of the bytes of a whole number in the float's place."""

    name: str
    least: int
    most: int
    code: str


_KINDS: Final = {
    1: _Kind("Uint8", 0, 0xFF, "<Bxxx"),
    2: _Kind("Int8", -0x80, 0x7F, "<bxxx"),
    3: _Kind("Uint16", 0, 0xFFFF, "<Hxx"),
    4: _Kind("Int16", -0x8000, 0x7FFF, "<hxx"),
    5: _Kind("Uint32", 0, 0xFFFF_FFFF, "<I"),
    6: _Kind("Int32", -0x8000_0000, 0x7FFF_FFFF, "<i"),
}


class Value(NamedTuple):
    """kind: MAV_PARAM_TYPE. value: None if the boat says what is no number."""

    value: float | None
    kind: int

    @property
    def type(self) -> str:
        """The name in the metadata's schema; Float for what it does not know."""
        kind = _KINDS.get(self.kind)
        return "Float" if kind is None else kind.name

    @property
    def is_whole(self) -> bool:
        """Whether only whole numbers are possible."""
        return self.kind in _KINDS

    def number(self) -> float | int | None:
        """As people write it."""
        return None if self.value is None else float_or_int(self.value, self.is_whole)

    def text(self) -> str:
        """As people write it, for a sentence or a file."""
        number = self.number()
        return say("param.no_number") if number is None else write(number)


def float_or_int(value: float, is_whole: bool) -> float | int:
    """The shortest number with the same 32-bit float, or the whole number."""
    return round(value) if is_whole else float(shortest(value))


def write(number: float) -> str:
    """A number without an unneeded .0."""
    return str(number) if isinstance(number, int) else repr(number).removesuffix(".0")


def name_of(message: Message) -> str | None:
    """Of PARAM_VALUE or PARAM_ERROR; None if it cannot be shown."""
    name = str(message.param_id).split("\0", 1)[0]
    return name if NAME.fullmatch(name) else None


def decode(message: Message, is_bytewise: bool) -> Value:
    """The value of a PARAM_VALUE."""
    raw, kind = float(message.param_value), int(message.param_type)
    whole = _KINDS.get(kind)
    if is_bytewise and whole is not None:
        (number,) = struct.unpack(whole.code, struct.pack("<f", raw))
        return Value(float(number), kind)
    if not math.isfinite(raw):
        return Value(None, kind)
    return Value(float(round(raw)) if whole is not None else raw, kind)


def encode(value: float, kind: int, is_bytewise: bool) -> float:
    """The value as PARAM_SET carries it."""
    whole = _KINDS.get(kind)
    if is_bytewise and whole is not None:
        (raw,) = struct.unpack("<f", struct.pack(whole.code, round(value)))
        return float(raw)
    return value


def flaw_of(value: float, kind: int, is_bytewise: bool) -> str:
    """Why a value cannot be one of this type, in words; empty if it can."""
    whole = _KINDS.get(kind)
    if not math.isfinite(value) or (whole is None and as_float32(value) != struct_float32(value)):
        return say("answer.param_flaw.number")
    if whole is None:
        return ""
    if value != round(value):
        return say("answer.param_flaw.whole")
    if not whole.least <= value <= whole.most:
        return say("answer.param_flaw.outside", least=str(whole.least), most=str(whole.most))
    if not is_bytewise and abs(value) > _MOST_EXACT and as_float32(value) != value:
        return say("answer.param_flaw.exact")
    return ""


def struct_float32(value: float) -> float | None:
    """The 32-bit float of a value; None beyond the largest."""
    try:
        (near,) = struct.unpack("<f", struct.pack("<f", value))
    except OverflowError:
        return None
    return float(near)


def is_same(one: float, other: float) -> bool:
    """Whether both are the same 32-bit float."""
    return one == other or struct_float32(one) == struct_float32(other)
