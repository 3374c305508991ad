"""Reading a file over MAVLink FTP the ways that clients do: by burst, then the gaps one by one."""

from pymavlink.dialects.v20 import all as dialect
from station_client import FileReply, StationClient, file_request

BLOCK_BYTES = 239
OPEN, READ, BURST, TERMINATE, RESET = (
    dialect.MAV_FTP_OPCODE_OPENFILERO,
    dialect.MAV_FTP_OPCODE_READFILE,
    dialect.MAV_FTP_OPCODE_BURSTREADFILE,
    dialect.MAV_FTP_OPCODE_TERMINATESESSION,
    dialect.MAV_FTP_OPCODE_RESETSESSION,
)
ACK, NAK = dialect.MAV_FTP_OPCODE_ACK, dialect.MAV_FTP_OPCODE_NAK


class FileRefusedError(Exception):
    """The vehicle answered NAK; args: the MAV_FTP_ERR."""


class FileClient:
    """One conversation with a vehicle's file server."""

    def __init__(self, client: StationClient) -> None:
        self._client = client
        self._sequence = 0

    def ask(self, opcode: int, session: int = 0, **values: object) -> FileReply | None:
        """One request and its reply, whose sequence number is one higher; None where none comes."""
        habits = self._client.habits
        self._sequence = (self._sequence + 1) & 0xFFFF
        reply = self._client.ask(
            f"file {opcode}",
            file_request(self._client.vehicle, self._sequence, opcode, session, **values),
            self._answers(opcode),
            habits.file_wait_s,
            habits.file_tries,
        )
        if reply is None:
            return None
        answer = FileReply.of(reply)
        self._sequence = answer.sequence
        return answer

    def _answers(self, opcode: int):  # type: ignore[no-untyped-def]  # noqa: ANN202
        expected = (self._sequence + 1) & 0xFFFF

        def is_answer(message) -> bool:  # type: ignore[no-untyped-def]  # noqa: ANN001
            if message.get_type() != "FILE_TRANSFER_PROTOCOL":
                return False
            reply = FileReply.of(message)
            return reply.request == opcode and reply.sequence == expected and reply.opcode in (ACK, NAK)

        return is_answer

    def open(self, path: str) -> tuple[int, int] | None:
        """Session and length of a file.

        Raises:
            FileRefusedError: the vehicle will not.
        """
        reply = self.ask(OPEN, data=path.encode())
        if reply is None:
            return None
        if reply.opcode == NAK:
            raise FileRefusedError(reply.data[0])
        return reply.session, int.from_bytes(reply.data[:4], "little")

    def read(self, path: str) -> bytes | None:
        """A whole file: a burst, what it left out block by block, then the session's end.

        Raises:
            FileRefusedError: the vehicle will not.
        """
        opened = self.open(path)
        if opened is None:
            return None
        session, length = opened
        blocks = self._burst(session, length)
        for offset in range(0, length, BLOCK_BYTES):
            if offset not in blocks:
                reply = self.ask(READ, session, offset=offset, size=BLOCK_BYTES)
                if reply is None or reply.opcode == NAK:
                    return None
                blocks[offset] = reply.data
        self.ask(TERMINATE, session)
        return b"".join(blocks[offset] for offset in sorted(blocks))[:length]

    def _burst(self, session: int, length: int) -> dict[int, bytes]:
        client = self._client
        self._sequence = (self._sequence + 1) & 0xFFFF
        blocks: dict[int, bytes] = {}
        client.asked["burst"] += 1
        client.send(file_request(client.vehicle, self._sequence, BURST, session, offset=0, size=BLOCK_BYTES))
        while len(blocks) * BLOCK_BYTES < length:
            message = client.hear(
                lambda m: m.get_type() == "FILE_TRANSFER_PROTOCOL", client.habits.file_wait_s
            )
            if message is None:
                break
            reply = FileReply.of(message)
            if reply.request != BURST or reply.session != session:
                continue
            self._sequence = max(self._sequence, reply.sequence)
            if reply.opcode == NAK:
                break
            blocks[reply.offset] = reply.data
        return blocks
