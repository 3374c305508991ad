"""Files of component metadata as they come: packed by xz or gzip, or plain; with a checksum."""

import lzma
import zlib
from typing import Final

from mission_tools.station.parameters.metadata import Descriptions, MetadataError, parse

MOST_PACKED_BYTES: Final = 2_000_000
MOST_BYTES: Final = 8_000_000  # ArduPilot's texts have some 2 MB
_MOST_MEMORY: Final = 20_000_000  # for a dictionary: 9 MB by xz -6, its default
_XZ: Final = b"\xfd7zXZ\x00"
_GZIP: Final = b"\x1f\x8b"
_GZIP_HEADER: Final = 16 + zlib.MAX_WBITS


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
