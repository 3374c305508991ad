"""Checks a wheel of mavboat (PEP 427) that came from outside, before anything of it is unpacked.

    inspect_wheel(Path("mavboat-0.2.0-py3-none-any.whl"))

The checks bound what a hostile file can cost in memory and time, and what it can write: files of mavboat's
own packages, and its programs by name. They say nothing about what its code does.
"""

import base64
import binascii
import configparser
import csv
import hashlib
import importlib.metadata
import io
import platform
import re
import stat
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from email.message import Message
from email.parser import HeaderParser
from pathlib import Path
from typing import IO, Final

from companion.core.errors import ConfigError
from companion.core.requirement import satisfies, unmet_requirement

DISTRIBUTION: Final = "mavboat"
MOST_FILES: Final = 3_000
MOST_PACKED_BYTES: Final = 30_000_000
MOST_UNPACKED_BYTES: Final = 100_000_000
_MOST_DIRECTORY_BYTES: Final = 1_000_000  # of the zip's central directory: 3,000 names of some 300 bytes
_MOST_TEXT_BYTES: Final = 1_000_000  # of RECORD, METADATA, WHEEL and entry_points.txt
PACKAGES: Final = ("companion", "mission_tools", "sitl")
_FILE_NAME = re.compile(
    r"(?P<name>[A-Za-z0-9._]+)-(?P<version>[0-9][A-Za-z0-9._+!]*)(?:-[0-9][A-Za-z0-9._]*)?"
    r"-(?P<python>[A-Za-z0-9_.]+)-(?P<abi>[A-Za-z0-9_.]+)-(?P<platform>[A-Za-z0-9_.]+)\.whl",
    re.ASCII,
)
_PROGRAM = re.compile(r"(?:boat|mission)-[a-z]{1,30}", re.ASCII)
_END = b"PK\x05\x06"  # of the record at a zip's end (APPNOTE 4.3.16): 22 bytes without a comment
_END_BYTES: Final = 22
_ZIP64 = b"PK\x06\x07"  # its locator of 20 bytes stands before that record
_CHUNK_BYTES: Final = 65_536


@dataclass(frozen=True, slots=True)
class WheelInfo:
    """A wheel that passed. name: of the file, without folders."""

    version: str
    name: str


def installed_version(name: str) -> str | None:
    """The version of an installed distribution; None if there is none."""
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def inspect_wheel(path: Path, version_of: Callable[[str], str | None] = installed_version) -> WheelInfo:
    """The version and the name of a wheel that can be installed here. Reads the whole file; needs no network.

    version_of: the installed version of a distribution, None if there is none.

    Raises:
        ConfigError: one sentence that names the file and what was expected.
    """
    name = path.name[:120]
    try:
        with path.open("rb") as file:
            return _inspect(file, path.name, version_of)
    except ConfigError as error:
        raise ConfigError(f"{name}: {error}") from None
    except (OSError, zipfile.BadZipFile, zlib.error, EOFError) as error:
        raise ConfigError(f"{name}: cannot be read as a wheel: {error}") from None
    except (RuntimeError, ValueError, NotImplementedError, csv.Error, configparser.Error) as error:
        raise ConfigError(f"{name}: not a valid wheel: {' '.join(str(error).split())[:200]}") from None


def _inspect(file: IO[bytes], name: str, version_of: Callable[[str], str | None]) -> WheelInfo:
    version = _version_of_name(name)
    _check_end(file)
    with zipfile.ZipFile(file) as archive:
        folder = f"{DISTRIBUTION}-{version}.dist-info"
        files = _checked_names(archive, folder)
        texts = _texts(archive, files, folder)
        _check_record(archive, files, f"{folder}/RECORD", texts["RECORD"])
    _check_format(HeaderParser().parsestr(texts["WHEEL"]))
    _check_programs(texts.get("entry_points.txt", ""))
    _check_metadata(HeaderParser().parsestr(texts["METADATA"]), version, version_of)
    return WheelInfo(version, name)


def _version_of_name(name: str) -> str:
    found = _FILE_NAME.fullmatch(name) if len(name) <= 120 else None
    if found is None:
        raise ConfigError("not the name of a wheel; expected such as mavboat-1.2.3-py3-none-any.whl")
    if re.sub(r"[-_.]+", "-", found["name"]).lower() != DISTRIBUTION:
        raise ConfigError(f"a wheel of {found['name']}; expected one of {DISTRIBUTION}")
    if (found["python"], found["abi"], found["platform"]) != ("py3", "none", "any"):
        raise ConfigError("made for one kind of machine; expected a wheel for every machine, py3-none-any")
    return found["version"]


def _check_end(file: IO[bytes]) -> None:
    """Bound the central directory before zipfile reads it into memory."""
    size = file.seek(0, io.SEEK_END)
    if size > MOST_PACKED_BYTES:
        raise ConfigError(f"{size} bytes; expected at most {MOST_PACKED_BYTES}")
    file.seek(max(0, size - _END_BYTES - 20))
    tail = file.read()
    end = tail[-_END_BYTES:]
    if not end.startswith(_END) or end[20:] != b"\0\0" or _ZIP64 in tail[:-_END_BYTES]:
        raise ConfigError("not a plain zip file; expected one without a comment, not damaged or cut off")
    if int.from_bytes(end[12:16], "little") > _MOST_DIRECTORY_BYTES:
        raise ConfigError(f"too many files; expected at most {MOST_FILES}")


def _checked_names(archive: zipfile.ZipFile, folder: str) -> dict[str, zipfile.ZipInfo]:
    members = archive.infolist()
    if len(members) > MOST_FILES:
        raise ConfigError(f"{len(members)} files; expected at most {MOST_FILES}")
    files: dict[str, zipfile.ZipInfo] = {}
    for member in members:
        name = member.orig_filename
        parts = name.removesuffix("/").split("/")
        is_odd = any(part in ("", ".", "..") or not part.isprintable() or "\\" in part for part in parts)
        if is_odd or name != member.filename or len(name) > 255:
            raise ConfigError(f"member {name[:80]!r}: not a plain relative path")
        if parts[0] not in (*PACKAGES, folder) or (len(parts) < 2 and not member.is_dir()):
            raise ConfigError(
                f"member {name[:80]!r}: expected files in {', '.join(PACKAGES)} and {folder} only"
            )
        if name in files:
            raise ConfigError(f"member {name[:80]!r}: there twice")
        kind = stat.S_IFMT(member.external_attr >> 16)
        if kind not in (0, stat.S_IFDIR if member.is_dir() else stat.S_IFREG):
            raise ConfigError(f"member {name[:80]!r}: a link or a device; expected a plain file")
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise ConfigError(f"member {name[:80]!r}: packed in an unusual way; expected deflate")
        if member.is_dir() and member.file_size:
            raise ConfigError(f"member {name[:80]!r}: a folder with content")
        files[name] = member
    return {name: member for name, member in files.items() if not member.is_dir()}


def _texts(archive: zipfile.ZipFile, files: dict[str, zipfile.ZipInfo], folder: str) -> dict[str, str]:
    texts = {}
    for name in ("RECORD", "METADATA", "WHEEL", "entry_points.txt"):
        member = files.get(f"{folder}/{name}")
        if member is None:
            if name == "entry_points.txt":
                continue
            raise ConfigError(f"no {folder}/{name}; expected one in every wheel")
        with archive.open(member) as part:
            content = part.read(_MOST_TEXT_BYTES + 1)
        if len(content) > _MOST_TEXT_BYTES:
            raise ConfigError(f"member {name}: more than {_MOST_TEXT_BYTES} bytes")
        texts[name] = content.decode("utf-8")
    return texts


def _check_record(
    archive: zipfile.ZipFile, files: dict[str, zipfile.ZipInfo], record: str, text: str
) -> None:
    rows = list(csv.reader(io.StringIO(text)))
    hashes = {row[0]: row[1] for row in rows if len(row) == 3}
    if len(hashes) != len(rows):
        raise ConfigError("RECORD: a line twice or not of three fields")
    if odd := sorted(hashes.keys() ^ files.keys()):
        where = "in the wheel" if odd[0] in hashes else "in RECORD"
        raise ConfigError(f"member {odd[0][:80]!r}: not {where}")
    left = MOST_UNPACKED_BYTES
    for name, member in files.items():
        digest = hashlib.sha256()
        with archive.open(member) as part:
            while content := part.read(_CHUNK_BYTES):
                left -= len(content)
                if left < 0:
                    raise ConfigError(f"unpacks to more than {MOST_UNPACKED_BYTES} bytes")
                digest.update(content)
        if name != record and _decoded(hashes[name]) != digest.digest():
            raise ConfigError(
                f"member {name[:80]!r}: its content is not what RECORD says; copy the file again"
            )


def _decoded(text: str) -> bytes | None:
    kind, _, encoded = text.partition("=")
    if kind != "sha256":
        return None
    try:
        return base64.b64decode(encoded + "=" * (-len(encoded) % 4), altchars=b"-_", validate=True)
    except binascii.Error:
        return None


def _check_format(wheel: Message) -> None:
    if not str(wheel["Wheel-Version"]).startswith("1.") or str(wheel["Root-Is-Purelib"]).lower() != "true":
        raise ConfigError("WHEEL: expected Wheel-Version 1 and Root-Is-Purelib: true")


def _check_programs(text: str) -> None:
    """An entry point becomes a file beside Python's own."""
    parser = configparser.ConfigParser(interpolation=None, delimiters=("=",))
    parser.optionxform = str  # type: ignore[assignment]
    parser.read_string(text)
    for section in parser.sections():
        for name in parser[section]:
            if section != "console_scripts" or not _PROGRAM.fullmatch(name):
                raise ConfigError(f"entry point {name[:40]!r}: expected programs called boat-… or mission-…")


def _check_metadata(metadata: Message, version: str, version_of: Callable[[str], str | None]) -> None:
    if str(metadata["Name"]).lower() != DISTRIBUTION or str(metadata["Version"]) != version:
        stated = f"{metadata['Name']} {metadata['Version']}"
        raise ConfigError(
            f"METADATA: {stated[:80]}; expected {DISTRIBUTION} {version}, as in the file's name"
        )
    needed = str(metadata["Requires-Python"] or "")
    if not satisfies(platform.python_version(), needed):
        raise ConfigError(f"needs Python {needed}, and {platform.python_version()} is installed")
    for requirement in metadata.get_all("Requires-Dist", []):
        if why := unmet_requirement(str(requirement), version_of):
            raise ConfigError(why)
