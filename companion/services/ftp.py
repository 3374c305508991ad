"""FILE_TRANSFER_PROTOCOL: this boat has no files to hand out yet, and says so at once.

A station that asks for the parameters as a file would wait many seconds in silence; refused, it goes on with
the parameter list. Frames after the MAVLink guide, "MAVLink FTP Protocol: Payload Format".
"""

import struct

from companion.mavlink.dialect import Message, dialect
from companion.services.outbox import Origin, Outbox

_HEADER = struct.Struct(
    "<HBBBBBBI"
)  # sequence, session, opcode, size, request's opcode, burst end, pad, offset
_PAYLOAD_BYTES = 251


class FtpService:
    """Refuses every request: a file that is to be opened is not found, anything else is not known."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox

    def handle(self, message: Message, origin: Origin) -> None:
        """Answer a request; a reply that came to us by mistake is not answered."""
        sequence, session, opcode = struct.unpack_from("<HBB", bytes(message.payload))
        if opcode in (dialect.MAV_FTP_OPCODE_ACK, dialect.MAV_FTP_OPCODE_NAK):
            return
        is_open = opcode in (dialect.MAV_FTP_OPCODE_OPENFILERO, dialect.MAV_FTP_OPCODE_OPENFILEWO)
        error = dialect.MAV_FTP_ERR_FILENOTFOUND if is_open else dialect.MAV_FTP_ERR_UNKNOWNCOMMAND
        header = _HEADER.pack(
            (sequence + 1) & 0xFFFF, session, dialect.MAV_FTP_OPCODE_NAK, 1, opcode, 0, 0, 0
        )
        payload = (header + bytes([error])).ljust(_PAYLOAD_BYTES, b"\x00")
        address = origin.address
        self._outbox.send(
            origin.channel,
            dialect.MAVLink_file_transfer_protocol_message(0, address.system, address.component, payload),
        )
