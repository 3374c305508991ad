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
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import msgspec
from msgspec import Raw, Struct, field

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


class _Choice(Struct):
    value: float
    description: str = ""


class _Bit(Struct):
    index: int
    description: str = ""


class _Parameter(Struct, rename="camel"):
    name: str
    short_desc: str = ""
    long_desc: str = ""
    units: str = ""
    default: float | None = None
    decimal_places: int | None = None
    min: float | None = None
    max: float | None = None
    increment: float | None = None
    reboot_required: bool = False
    group: str = ""
    category: str = ""
    values: list[_Choice] = field(default_factory=list)
    bitmask: list[_Bit] = field(default_factory=list)
    read_only: bool = False


class _File(Struct):
    parameters: list[Raw]


class MetadataError(ValueError):
    """A file that is no metadata. The text is for people."""


@dataclass(frozen=True, slots=True)
class Description:
    """Of one parameter. decimals, step: as shown. values: number and text; bits: number and text."""

    text: str = ""
    long: str = ""
    unit: str = ""
    low: float | None = None
    high: float | None = None
    step: float | None = None
    decimals: int | None = None
    values: tuple[tuple[float, str], ...] = ()
    bits: tuple[tuple[int, str], ...] = ()
    default: float | None = None
    group: str = ""
    category: str = ""
    needs_restart: bool = False
    read_only: bool = False


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
    """Read a parameter file, not packed. Takes tens of milliseconds for thousands of entries: use a thread.

    Raises:
        MetadataError: it is none.
    """
    try:
        raws = msgspec.json.decode(content, type=_File).parameters
    except (msgspec.MsgspecError, UnicodeError, RecursionError):
        raise MetadataError("the file is not JSON with a list of parameters") from None
    by_name: dict[str, Description] = {}
    for raw in raws[:MOST_ENTRIES]:
        try:
            entry = msgspec.json.decode(raw, type=_Parameter)
        except (msgspec.MsgspecError, UnicodeError, RecursionError):
            continue
        if _NAME.fullmatch(entry.name):
            by_name[entry.name] = _described(entry)
    return Descriptions(by_name)


def _described(entry: _Parameter) -> Description:
    low, high = entry.min, entry.max
    if low is not None and high is not None and low > high:
        low = high = None
    step, decimals, choices = entry.increment, entry.decimal_places, entry.values[:_MOST_CHOICES]
    bits = sorted((one.index, one.description) for one in entry.bitmask if 0 <= one.index <= _MOST_BIT)
    return Description(
        text=clean(entry.short_desc)[:_MOST_TEXT],
        long=_paragraphs(entry.long_desc),
        unit=clean(entry.units)[:_MOST_TEXT],
        low=low,
        high=high,
        step=step if step is not None and step > 0.0 and math.isfinite(step) else None,
        decimals=None if decimals is None else min(max(decimals, 0), _MOST_DECIMALS),
        values=tuple((one.value, clean(one.description)[:_MOST_TEXT]) for one in choices),
        bits=tuple((index, clean(text)[:_MOST_TEXT]) for index, text in bits),
        default=entry.default,
        group=clean(entry.group)[:_MOST_TEXT],
        category=clean(entry.category)[:_MOST_TEXT],
        needs_restart=entry.reboot_required,
        read_only=entry.read_only,
    )


def _paragraphs(text: str) -> str:
    lines = (clean(line) for line in text[:_MOST_LONG].splitlines())
    return "\n".join(line for line in lines if line)


def unpack(content: bytes, most_bytes: int = MOST_BYTES) -> bytes:
    """The plain file.

    Raises:
        MetadataError: broken, or longer than most_bytes.
    """
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
    """Unpack, check and parse a parameter file. Takes up to some 0.1 s: use a thread.

    Raises:
        MetadataError: it is none, or damaged.
    """
    plain = unpack(content)
    if not is_intact(content, plain, crc):
        raise MetadataError("the checksum of the file is another")
    return parse(plain)
