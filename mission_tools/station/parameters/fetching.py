"""The file with the parameters' texts, fetched from the boat by MAVLink FTP as QGroundControl does.

Theory of operation
-------------------
COMPONENT_METADATA is requested, then its older form COMPONENT_INFORMATION; a boat that sends neither has no
texts. Its uri leads to the general file, and that to the parameter file. Each is read and checked by its CRC;
both are tried TRIES times. Files that are not on the boat (https) are not fetched, as the page needs no
internet. What was fetched is kept by the general file's CRC, for a boat that starts again.
"""

import re
from collections.abc import Callable
from typing import Final, Literal, NamedTuple

import msgspec
from msgspec import Struct

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.metadata_messages import ComponentInformation, ComponentMetadata
from mission_tools.station.ftp.jobs import FtpFailure
from mission_tools.station.parameters.metadata import MOST_PACKED_BYTES, MetadataError, is_intact, unpack
from mission_tools.station.wire import command_long

METADATA: Final[int] = ComponentMetadata.id
INFORMATION: Final[int] = ComponentInformation.id
ASK_S: Final = 1.5
ASKS: Final = 3  # of each of the two messages
TRIES: Final = 3
AGAIN_S: Final = 5.0  # after a failure
_PARAMETERS: Final = 1  # COMP_METADATA_TYPE_PARAMETER
_MOST_GENERAL_BYTES: Final = 100_000
_URI: Final = re.compile(r"mftp:(?://)?(?:\[;comp=(\d{1,3})\])?(/?[!-~]{1,200})")

TextState = Literal["waiting", "asking", "reading", "here", "none"]
Read = Callable[[str, Callable[[bytes | FtpFailure], None], int], object]
"""Read a file of the boat: path, what is called once with the content or why not, and its most bytes."""


class Packed(NamedTuple):
    """A parameter file as it came. crc: by the general file; None without one."""

    content: bytes
    crc: int | None


class _Type(Struct, rename="camel"):
    type: int
    uri: str
    file_crc: int | None = None


class _General(Struct, rename="camel"):
    metadata_types: list[_Type]


class Fetching:
    """One boat's file. send: to this boat; read: by FTP."""

    def __init__(self, boat: Address, send: Callable[[Message], None], read: Read) -> None:
        self._boat = boat
        self._send = send
        self._read = read
        self.state: TextState = "waiting"
        self.packed: Packed | None = None
        self._crc: int | None = None  # of the general file
        self._asked = 0
        self._failed = 0
        self._due_s = float("-inf")
        self._now_s = 0.0

    def restart(self) -> None:
        """The boat has started again: its program may be another."""
        if self.state != "reading":
            self.state, self._asked, self._failed = "waiting", 0, 0

    def handle(self, message: Message, now_s: float) -> None:
        """Take COMPONENT_METADATA or COMPONENT_INFORMATION."""
        self._now_s = now_s
        if self.state != "asking":
            return
        if message.get_msgId() == METADATA:
            uri, crc = message.uri, message.file_crc
        else:
            uri, crc = message.general_metadata_uri, message.general_metadata_file_crc
        path = self._path(str(uri))
        if path is None:
            self.state = "none"
        elif self.packed is not None and crc == self._crc:
            self.state = "here"
        else:
            self.state, self.packed = "reading", None
            self._read(path, lambda content: self._on_general(content, crc), _MOST_GENERAL_BYTES)

    def poll(self, now_s: float, is_wanted: bool) -> None:
        """Ask for the first message. is_wanted: and the boat is heard."""
        self._now_s = now_s
        if not is_wanted or self.state not in ("waiting", "asking") or now_s < self._due_s:
            return
        if self._asked >= 2 * ASKS:
            self.state = "none"
            return
        number = METADATA if self._asked < ASKS else INFORMATION
        self.state, self._asked, self._due_s = "asking", self._asked + 1, now_s + ASK_S
        self._send(command_long(self._boat, dialect.MAV_CMD_REQUEST_MESSAGE, number))

    def _path(self, uri: str) -> str | None:
        """Of a file on this component of the boat."""
        match = _URI.fullmatch(uri)
        if match is None or (match[1] is not None and int(match[1]) != self._boat.component):
            return None
        return match[2]

    def _on_general(self, content: bytes | FtpFailure, crc: int) -> None:
        types = _metadata_types(content, crc or None) if isinstance(content, bytes) else None
        if types is None:
            self._fail()
            return
        found = [(one, path) for one in types if one.type == _PARAMETERS and (path := self._path(one.uri))]
        if not found:
            self.state = "none"
            return
        one, path = found[0]
        self._crc = crc
        self._read(path, lambda content: self._on_parameters(content, one.file_crc), MOST_PACKED_BYTES)

    def _on_parameters(self, content: bytes | FtpFailure, crc: int | None) -> None:
        if isinstance(content, FtpFailure):
            self._fail()
            return
        self.packed, self.state = Packed(content, crc), "here"

    def refuse(self) -> None:
        """What was fetched cannot be read: once more."""
        if self.state == "here":
            self.packed = None
            self._fail()

    def _fail(self) -> None:
        self._failed += 1
        self.state = "none" if self._failed >= TRIES else "waiting"
        self._asked, self._due_s = 0, self._now_s + AGAIN_S


def _metadata_types(content: bytes, crc: int | None) -> list[_Type] | None:
    """Of a general file; None if it is none, or damaged."""
    try:
        plain = unpack(content, _MOST_GENERAL_BYTES)
        types = msgspec.json.decode(plain, type=_General).metadata_types
    except (MetadataError, msgspec.MsgspecError, UnicodeError, RecursionError):
        return None
    return types if is_intact(content, plain, crc) else None
