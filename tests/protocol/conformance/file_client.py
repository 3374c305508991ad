"""Reading a file over MAVLink FTP the ways that clients do: by burst, then the gaps one by one."""

from ftp_client import ACK, NAK, Reply, reply_of, request_of
from station_client import StationClient
from vehicle_line import Message

from companion.mavlink.address import Address
from companion.mavlink.ftp_frames import Opcode

BLOCK_BYTES = 239


class FileRefusedError(Exception):
    """The vehicle answered NAK; args: the MAV_FTP_ERR."""


class FileClient:
    """One conversation with a vehicle's file server."""

    def __init__(self, client: StationClient) -> None:
        self._client = client
        self._vehicle = Address(*client.vehicle)
        self._sequence = 0

    def ask(
        self, opcode: int, session: int = 0, data: bytes = b"", offset: int = 0, size: int | None = None
    ) -> Reply | None:
        """One request and its reply, whose sequence number is one higher; None where none comes."""
        habits = self._client.habits
        self._sequence = (self._sequence + 1) & 0xFFFF
        expected = (opcode, (self._sequence + 1) & 0xFFFF)
        answer: list[Reply] = []

        def is_answer(message: Message) -> bool:
            if message.get_type() == "FILE_TRANSFER_PROTOCOL":
                reply = reply_of(bytes(message.payload))
                if (reply.request_opcode, reply.sequence) == expected and reply.opcode in (ACK, NAK):
                    answer.append(reply)
            return bool(answer)

        request = request_of(self._sequence, opcode, data, session, offset, size, self._vehicle)
        self._client.ask(f"file {opcode}", request, is_answer, habits.file_wait_s, habits.file_tries)
        if not answer:
            return None
        self._sequence = answer[0].sequence
        return answer[0]

    def read(self, path: str) -> bytes | None:
        """A whole file: a burst, what it left out block by block, then the session's end.

        Raises:
            FileRefusedError: the vehicle will not.
        """
        opened = self.ask(Opcode.OPEN_FILE_RO, data=path.encode())
        if opened is None:
            return None
        if opened.opcode == NAK:
            raise FileRefusedError(opened.data[0])
        session, length = opened.session, int.from_bytes(opened.data[:4], "little")
        blocks = self._burst(session, length)
        for offset in range(0, length, BLOCK_BYTES):
            if offset not in blocks:
                reply = self.ask(Opcode.READ_FILE, session, offset=offset, size=BLOCK_BYTES)
                if reply is None or reply.opcode == NAK:
                    return None
                blocks[offset] = reply.data
        self.ask(Opcode.TERMINATE_SESSION, session)
        return b"".join(blocks[offset] for offset in sorted(blocks))[:length]

    def _burst(self, session: int, length: int) -> dict[int, bytes]:
        client, blocks = self._client, dict[int, bytes]()
        self._sequence = (self._sequence + 1) & 0xFFFF
        client.asked["burst"] += 1
        burst = Opcode.BURST_READ_FILE
        client.send(request_of(self._sequence, burst, b"", session, 0, BLOCK_BYTES, self._vehicle))
        while len(blocks) * BLOCK_BYTES < length:
            message = client.hear(
                lambda m: m.get_type() == "FILE_TRANSFER_PROTOCOL", client.habits.file_wait_s
            )
            if message is None:
                break
            reply = reply_of(bytes(message.payload))
            if reply.request_opcode != burst or reply.session != session:
                continue
            self._sequence = max(self._sequence, reply.sequence)
            if reply.opcode == NAK:
                break
            blocks[reply.offset] = reply.data
        return blocks
