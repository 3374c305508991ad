"""Records of a log in ArduPilot's DataFlash format, as the log itself defines them. Any file may be read.

After ArduPilot's libraries/AP_Logger/README.md and LogStructure.h: each record is A3 95, a type, and fields;
records of type 128 (FMT) say what the fields of a type are.
"""

import math
import struct
from collections.abc import Iterator, Mapping
from typing import Final, NamedTuple

HEAD: Final = b"\xa3\x95"
_FMT: Final = 128
_FMT_FIELDS: Final = struct.Struct("<BB4s16s64s")
HEAD_BYTES: Final = 3
_TYPES: Final[Mapping[str, tuple[str, float]]] = {  # of a field: struct's letter, and a factor
    "a": ("64s", 0), "n": ("4s", 0), "N": ("16s", 0), "Z": ("64s", 0),
    "b": ("b", 1), "B": ("B", 1), "M": ("B", 1), "h": ("h", 1), "H": ("H", 1), "i": ("i", 1), "I": ("I", 1),
    "q": ("q", 1), "Q": ("Q", 1), "f": ("f", 1), "d": ("d", 1), "g": ("e", 1),
    "c": ("h", 0.01), "C": ("H", 0.01), "e": ("i", 0.01), "E": ("I", 0.01), "L": ("i", 1e-7),
}  # fmt: skip
_MOST_TEXT: Final = 200

Value = float | str | None


class Record(NamedTuple):
    """values: in the order of the fields wanted; None for what this log does not have, or is no number."""

    name: str
    values: tuple[Value, ...]


class _Field(NamedTuple):
    place: int
    factor: float  # 0: a text


class Format(NamedTuple):
    """length: of the record, its head included. layout: what follows the head. name, wanted: empty of a
    record that is not wanted; a field that this log does not have is None.
    """

    length: int
    name: str = ""
    layout: struct.Struct = struct.Struct("")
    wanted: tuple[_Field | None, ...] = ()


class Log:
    """wanted: the fields of each record by its name. is_cut: parts of the file are no whole record."""

    def __init__(self, data: "bytes | memoryview", wanted: Mapping[str, tuple[str, ...]]) -> None:
        self.is_cut = False
        self.count = 0  # of all records
        self._data = data
        self._wanted = wanted
        self._formats: dict[int, Format] = {_FMT: Format(HEAD_BYTES + _FMT_FIELDS.size)}

    def records(self) -> Iterator[Record]:
        """Those wanted, in the order of the file."""
        for at, form in self.places():
            values = form.layout.unpack_from(self._data, at + HEAD_BYTES)
            yield Record(form.name, tuple(_value(values, field) for field in form.wanted))

    def places(self) -> "Iterator[tuple[int, Format]]":
        """Where in the file those wanted begin, and what they hold."""
        data, at, end = self._data, 0, len(self._data)
        format_of, (first, second) = self._formats.get, HEAD
        while at + HEAD_BYTES <= end:
            known = format_of(data[at + 2]) if data[at] == first and data[at + 1] == second else None
            if known is None or (after := at + known.length) > end:
                self.is_cut = True
                at = _next_head(data, at + 1)
                continue
            self.count += 1
            if known.name:
                yield at, known
            elif data[at + 2] == _FMT:
                self._define(bytes(data[at + HEAD_BYTES : after]))
            at = after
        self.is_cut |= at != end

    def _define(self, fields: bytes) -> None:
        kind, length, name, letters, labels = _FMT_FIELDS.unpack(fields)
        if kind == _FMT or length < HEAD_BYTES:
            return
        names = _text(labels).split(",")
        types = [_TYPES.get(letter) for letter in _text(letters)]
        known = [one for one in types if one is not None]
        wanted = self._wanted.get(_text(name))
        self._formats[kind] = Format(length)
        if wanted is None or len(known) != len(types) or len(types) != len(names):
            return
        whole = struct.Struct("<" + "".join(letter for letter, _ in known))
        if whole.size + HEAD_BYTES != length:
            return
        places = tuple(
            _Field(names.index(one), known[names.index(one)][1]) if one in names else None for one in wanted
        )
        self._formats[kind] = Format(length, _text(name), whole, places)


def _next_head(data: "bytes | memoryview", at: int) -> int:
    """Where the next record may begin; the end of the data if nowhere."""
    while at < len(data):
        chunk = bytes(data[at : at + 4096])
        found = chunk.find(HEAD)
        if found >= 0:
            return at + found
        at += max(len(chunk) - 1, 1)
    return at


def _value(values: tuple[object, ...], field: _Field | None) -> Value:
    if field is None:
        return None
    value = values[field.place]
    if isinstance(value, bytes):
        return _text(value)
    if not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return value * field.factor


def _text(raw: bytes) -> str:
    text = raw.split(b"\0")[0].decode("utf-8", "replace")
    return "".join(letter if letter.isprintable() else " " for letter in text)[:_MOST_TEXT].strip()
