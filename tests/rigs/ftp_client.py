"""A station's half of a file transfer, for tests: requests, and an endpoint's worth of service to ask."""

import struct
from concurrent.futures import Executor
from pathlib import Path
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.core.storage import InlineExecutor, MemoryStorage
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.ftp_frames import Code, Opcode
from companion.services.ftp.mounts import build_tree
from companion.services.ftp.service import FtpService
from companion.services.outbox import Origin, Outbox
from companion.services.parameters import ParameterService
from companion.services.statustext import StatusTextService

BOAT = Address(1, 1)
STATION = Origin(3, Address(255, 190))
ACK, NAK = 128, 129


class Reply(NamedTuple):
    """What the boat answered."""

    sequence: int
    session: int
    opcode: int
    request_opcode: int
    is_burst_over: bool
    offset: int
    data: bytes

    @property
    def code(self) -> Code | None:
        """Why it was refused; None when it was not."""
        return Code(self.data[0]) if self.opcode == NAK else None


def reply_of(payload: bytes) -> Reply:
    sequence, session, opcode, size, request_opcode, is_over, _, offset = struct.unpack_from(
        "<HBBBBBBI", payload
    )
    return Reply(sequence, session, opcode, request_opcode, bool(is_over), offset, payload[12 : 12 + size])


def request_of(
    sequence: int,
    opcode: int,
    data: bytes = b"",
    session: int = 0,
    offset: int = 0,
    size: int | None = None,
    target: Address = BOAT,
) -> Message:
    size = len(data) if size is None else size
    payload = struct.pack("<HBBBBBBI", sequence, session, opcode, size, 0, 0, 0, offset) + data
    message: Message = dialect.MAVLink_file_transfer_protocol_message(
        0, target.system, target.component, payload.ljust(251, b"\0")
    )
    return message


class Served:
    """A service with a tree, on a folder or without, and the station that asks it."""

    def __init__(
        self, folder: Path | None = None, worker: Executor | None = None, quota_mb: float = 1.0
    ) -> None:
        self.outbox = Outbox()
        self.parameters = Parameters(BoatConfig(), ROWS, MemoryStorage())
        self.listings = ParameterService(self.parameters, self.outbox, StatusTextService(self.outbox))
        tree = build_tree(self.parameters, self.listings, folder, quota_mb)
        self.service = FtpService(BOAT, self.outbox, tree, worker or InlineExecutor())
        self.now_s = 0.0
        self.sequence = 0

    def send(self, message: Message, origin: Origin = STATION) -> list[Reply]:
        """One request; the replies to it that come at once."""
        self.service.handle(message, origin, self.now_s)
        return self.replies(origin)

    def replies(self, origin: Origin = STATION) -> list[Reply]:
        """What has been sent to a station; the rest is thrown away."""
        return [
            reply_of(bytes(out.message.payload))
            for out in self.outbox.drain()
            if out.channel == origin.channel
            and out.message.get_type() == "FILE_TRANSFER_PROTOCOL"
            and (out.message.target_system, out.message.target_component) == tuple(origin.address)
        ]

    def tick(self, seconds: float = 0.02, origin: Origin = STATION) -> list[Reply]:
        """Time goes by."""
        self.now_s += seconds
        self.service.tick(self.now_s)
        return self.replies(origin)

    def ask(
        self,
        opcode: int,
        data: bytes = b"",
        session: int = 0,
        offset: int = 0,
        size: int | None = None,
        origin: Origin = STATION,
    ) -> Reply:
        """A new request and its one reply."""
        self.sequence = (self.sequence + 1) & 0xFFFF
        self.service.tick(self.now_s)
        (reply,) = self.send(request_of(self.sequence, opcode, data, session, offset, size), origin)
        assert reply.sequence == (self.sequence + 1) & 0xFFFF
        assert reply.request_opcode == opcode
        return reply

    def put(self, path: bytes, content: bytes) -> Reply:
        """Upload a file; the reply to its closing."""
        opened = self.ask(Opcode.CREATE_FILE, path)
        assert opened.opcode == ACK, opened
        for offset in range(0, len(content), 239):
            written = self.ask(Opcode.WRITE_FILE, content[offset : offset + 239], opened.session, offset)
            assert (written.opcode, written.offset) == (ACK, offset)
        return self.ask(Opcode.TERMINATE_SESSION, session=opened.session)

    def get(self, path: bytes) -> bytes:
        """Download a file block by block."""
        opened = self.ask(Opcode.OPEN_FILE_RO, path)
        assert opened.opcode == ACK, opened
        content = b""
        while (block := self.ask(Opcode.READ_FILE, b"", opened.session, len(content), 239)).opcode == ACK:
            content += block.data
        assert block.code is Code.END_OF_FILE
        assert struct.unpack("<I", opened.data) == (len(content),)
        assert self.ask(Opcode.TERMINATE_SESSION, session=opened.session).opcode == ACK
        return content

    def list(self, path: bytes) -> list[str]:
        """All of a folder's list."""
        lines: list[str] = []
        while (page := self.ask(Opcode.LIST_DIRECTORY, path, offset=len(lines))).opcode == ACK:
            assert page.data.endswith(b"\0")
            lines += page.data[:-1].decode().split("\0")
        assert page.code is Code.END_OF_FILE
        return lines
