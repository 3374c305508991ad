"""Component metadata of parameters: texts, units, ranges, choices.

After the MAVLink guide, "Component Metadata Protocol", and its parameter.schema.json. The file comes from the
boat: every entry is read by itself, and one that breaks the schema describes nothing. Texts and lists are
cut at bounds beyond those of ArduPilot's and PX4's files. A file comes plain or packed by xz or gzip, with a
checksum.
"""

import lzma
import math
import re
import zlib
from collections.abc import Mapping
from typing import Final, NamedTuple

import msgspec
from msgspec import Raw, Struct, field
from msgspec.structs import replace

from mission_tools.station.view import clean

MOST_PACKED_BYTES: Final = 2_000_000
MOST_BYTES: Final = 8_000_000  # ArduPilot's texts have some 2 MB
_MOST_MEMORY: Final = 20_000_000  # for a dictionary: 9 MB by xz -6, its default
_XZ: Final = b"\xfd7zXZ\x00"
_GZIP: Final = b"\x1f\x8b"
_GZIP_HEADER: Final = 16 + zlib.MAX_WBITS
MOST_ENTRIES: Final = 10_000
_MOST_TEXT: Final = 200
_MOST_LONG: Final = 4000
_MOST_CHOICES: Final = 256
_MOST_BIT: Final = 31
_MOST_DECIMALS: Final = 9
_NAME: Final = re.compile(r"[.\-a-zA-Z0-9_{}]{1,24}")
_NUMBER: Final = re.compile(r"\d+")
_INDEX: Final = "{n}"


class Choice(Struct, frozen=True):
    """A value and what it means."""

    value: float
    text: str = field(default="", name="description")


class Bit(Struct, frozen=True):
    """The number of a bit and what it means."""

    index: int
    text: str = field(default="", name="description")


class Description(Struct, frozen=True):
    """Of one parameter, by the schema's names in JSON. decimals, step: as shown."""

    text: str = field(default="", name="shortDesc")
    long: str = field(default="", name="longDesc")
    unit: str = field(default="", name="units")
    low: float | None = field(default=None, name="min")
    high: float | None = field(default=None, name="max")
    step: float | None = field(default=None, name="increment")
    decimals: int | None = field(default=None, name="decimalPlaces")
    values: list[Choice] = []
    bits: list[Bit] = field(default_factory=list, name="bitmask")
    default: float | None = None
    group: str = ""
    needs_restart: bool = field(default=False, name="rebootRequired")
    read_only: bool = field(default=False, name="readOnly")


class _Entry(Description, frozen=True, kw_only=True):
    name: str


class _File(Struct):
    parameters: list[Raw]


class MetadataError(ValueError):
    """A file that is no metadata. The text is for people."""


NOTHING: Final = Description()


class Descriptions(NamedTuple):
    """by_name: also of names with `{n}`, which stands for a number in the parameter's name."""

    by_name: Mapping[str, Description]

    def of(self, name: str) -> Description:
        """Of a parameter; empty if it is not described."""
        if (known := self.by_name.get(name)) is not None:
            return known
        for number in _NUMBER.finditer(name):
            template = f"{name[: number.start()]}{_INDEX}{name[number.end() :]}"
            if (known := self.by_name.get(template)) is not None:
                return _numbered(known, number[0])
        return NOTHING


def _numbered(one: Description, number: str) -> Description:
    return replace(
        one, **{name: getattr(one, name).replace(_INDEX, number) for name in ("text", "long", "group")}
    )


def parse(content: bytes) -> Descriptions:
    """Read a parameter file, not packed; MetadataError if it is none. Tens of ms for thousands of entries."""
    try:
        raws = msgspec.json.decode(content, type=_File).parameters
    except (msgspec.MsgspecError, UnicodeError, RecursionError):
        raise MetadataError("the file is not JSON with a list of parameters") from None
    by_name: dict[str, Description] = {}
    for raw in raws[:MOST_ENTRIES]:
        try:
            entry = msgspec.json.decode(raw, type=_Entry)
        except (msgspec.MsgspecError, UnicodeError, RecursionError):
            continue
        if _NAME.fullmatch(entry.name):
            by_name[entry.name] = _cleaned(entry)
    return Descriptions(by_name)


def _cleaned(entry: _Entry) -> Description:
    low, high, step, decimals = entry.low, entry.high, entry.step, entry.decimals
    if low is not None and high is not None and low > high:
        low = high = None
    bits = sorted((one.index, one.text) for one in entry.bits if 0 <= one.index <= _MOST_BIT)
    return replace(
        entry,
        text=_short(entry.text),
        long=_paragraphs(entry.long),
        unit=_short(entry.unit),
        low=low,
        high=high,
        step=step if step is not None and step > 0.0 and math.isfinite(step) else None,
        decimals=None if decimals is None else min(max(decimals, 0), _MOST_DECIMALS),
        values=[Choice(one.value, _short(one.text)) for one in entry.values[:_MOST_CHOICES]],
        bits=[Bit(index, _short(text)) for index, text in bits],
        group=_short(entry.group),
    )


def _short(text: str) -> str:
    return clean(text)[:_MOST_TEXT]


def _paragraphs(text: str) -> str:
    lines = (clean(line) for line in text[:_MOST_LONG].splitlines())
    return "\n".join(line for line in lines if line)


def unpack(content: bytes, most_bytes: int = MOST_BYTES) -> bytes:
    """The plain file; MetadataError if it is broken or longer than most_bytes."""
    try:
        if content.startswith(_XZ):
            xz = lzma.LZMADecompressor(lzma.FORMAT_XZ, memlimit=_MOST_MEMORY)
            plain, is_whole = xz.decompress(content, most_bytes + 1), xz.eof
        elif content.startswith(_GZIP):
            gzip = zlib.decompressobj(_GZIP_HEADER)
            plain, is_whole = gzip.decompress(content, most_bytes + 1), gzip.eof
        else:
            plain, is_whole = content, True
    except (lzma.LZMAError, zlib.error):
        raise MetadataError("the file is packed, and broken") from None
    if len(plain) > most_bytes:
        raise MetadataError(f"the file has more than {most_bytes // 1000} kB")
    if not is_whole:
        raise MetadataError("the file is packed, and ends too early")
    return plain


def crc32(content: bytes) -> int:
    """MAVLink's CRC-32 of a file: the usual polynomial, from 0, not inverted at the end."""
    return zlib.crc32(content, 0xFFFFFFFF) ^ 0xFFFFFFFF


def is_intact(content: bytes, plain: bytes, crc: int | None) -> bool:
    """Whether the checksum is that of the file as sent, or of what is packed in it: both are in use."""
    return crc is None or crc32(content) == crc or crc32(plain) == crc


def read_descriptions(content: bytes, crc: int | None) -> Descriptions:
    """Unpack, check and parse a parameter file; MetadataError if it is none. Up to 0.1 s: use a thread."""
    plain = unpack(content)
    if not is_intact(content, plain, crc):
        raise MetadataError("the checksum of the file is another")
    return parse(plain)
