"""Requests of MAVLink FTP under way to one boat: numbered, repeated until answered, then given up."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.ftp_frames import Reply, make_request

REPEAT_S: Final = 0.4  # eight polls of the station; a radio answers within 0.2 s
LONGEST_S: Final = 2.0  # each wait is longer than the last by half, up to this
TRIES: Final = 10  # at 40 % loss each way one request in a hundred gets no answer
_BURST_NUMBERS: Final = 1024  # the replies of a burst count up from its request; bursts have about 500

Answered = Callable[[Reply | None, float], None]
"""Called once with the reply, or None without one, and the time."""


@dataclass(slots=True)
class _Question:
    opcode: int
    message: Message
    answered: Answered
    due_s: float
    wait_s: float
    tries: int


class Asking:
    """Requests to one boat. send: to this boat."""

    def __init__(self, boat: Address, send: Callable[[Message], None]) -> None:
        self._boat = boat
        self._send = send
        self._number = 0
        self._open: dict[int, _Question] = {}  # by the number of the reply

    @property
    def count(self) -> int:
        """Requests without a reply."""
        return len(self._open)

    def ask(
        self,
        opcode: int,
        answered: Answered,
        now_s: float,
        *,
        session: int = 0,
        offset: int = 0,
        size: int = 0,
        data: bytes = b"",
        tries: int = TRIES,
    ) -> None:
        """Send a request. size: bytes to read."""
        message = self._message(opcode, session, offset, size or len(data), data)
        self._open[(self._number + 1) & 0xFFFF] = _Question(
            opcode, message, answered, now_s + REPEAT_S, REPEAT_S, tries - 1
        )
        self._number = (self._number + 1) & 0xFFFF
        self._send(message)

    def burst(self, opcode: int, session: int, offset: int, size: int) -> int:
        """Send a request for a burst, which is not repeated; returns its number, for `is_of_burst`."""
        number = self._number
        self._send(self._message(opcode, session, offset, size, b""))
        self._number = (self._number + _BURST_NUMBERS + 1) & 0xFFFF
        return number

    def handle(self, reply: Reply, now_s: float) -> None:
        """A reply; one that answers nothing is ignored."""
        question = self._open.get(reply.sequence)
        if question is not None and question.opcode == reply.opcode:
            del self._open[reply.sequence]
            question.answered(reply, now_s)

    def poll(self, now_s: float) -> None:
        """Repeat, and give up."""
        for number, question in list(self._open.items()):
            if now_s < question.due_s or self._open.get(number) is not question:
                continue
            if question.tries <= 0:
                del self._open[number]
                question.answered(None, now_s)
                continue
            question.tries -= 1
            question.wait_s = min(question.wait_s * 1.5, LONGEST_S)
            question.due_s = now_s + question.wait_s
            self._send(question.message)

    def drop(self) -> None:
        """Forget all requests; their replies are ignored."""
        self._open.clear()

    def _message(self, opcode: int, session: int, offset: int, size: int, data: bytes) -> Message:
        payload = make_request(self._number, session, opcode, offset, size, data)
        message: Message = dialect.MAVLink_file_transfer_protocol_message(0, *self._boat, payload)
        return message


def is_of_burst(reply: Reply, number: int) -> bool:
    """Whether a reply belongs to the burst with this number."""
    return 0 < (reply.sequence - number) & 0xFFFF <= _BURST_NUMBERS
