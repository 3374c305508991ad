"""A station that asks for a file is refused at once, in the frame that it waits for."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.services.ftp import FtpService
from companion.services.outbox import Origin, Outbox

STATION = Origin(3, Address(255, 190))


def request(sequence: int, session: int, opcode: int, path: bytes = b"") -> Message:
    header = struct.pack("<HBBBBBBI", sequence, session, opcode, len(path), 0, 0, 0, 0)
    payload = (header + path).ljust(251, b"\x00")
    message: Message = dialect.MAVLink_file_transfer_protocol_message(0, 1, 1, payload)
    return message


def answers(message: Message) -> list[tuple[int, Message]]:
    outbox = Outbox()
    FtpService(outbox).handle(message, STATION)
    return [(outgoing.channel or 0, outgoing.message) for outgoing in outbox.take()]


def test_a_file_to_be_opened_is_not_found() -> None:
    [(channel, answer)] = answers(request(7, 2, dialect.MAV_FTP_OPCODE_OPENFILERO, b"@PARAM/param.pck"))
    assert (channel, answer.target_system, answer.target_component) == (3, 255, 190)
    header = struct.unpack_from("<HBBBBBBI", bytes(answer.payload))
    nak = dialect.MAV_FTP_OPCODE_NAK
    assert header == (8, 2, nak, 1, dialect.MAV_FTP_OPCODE_OPENFILERO, 0, 0, 0)
    assert bytes(answer.payload)[12] == dialect.MAV_FTP_ERR_FILENOTFOUND


@given(sequence=st.integers(0, 0xFFFF), session=st.integers(0, 255), opcode=st.integers(0, 127))
def test_every_request_is_refused_under_the_next_number(sequence: int, session: int, opcode: int) -> None:
    [(_, answer)] = answers(request(sequence, session, opcode))
    assert struct.unpack_from("<HBBBB", bytes(answer.payload)) == (
        (sequence + 1) % 65536, session, dialect.MAV_FTP_OPCODE_NAK, 1, opcode,
    )  # fmt: skip


@pytest.mark.parametrize("reply", [dialect.MAV_FTP_OPCODE_ACK, dialect.MAV_FTP_OPCODE_NAK])
def test_a_reply_is_not_answered(reply: int) -> None:
    assert answers(request(1, 0, reply)) == []
