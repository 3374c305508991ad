"""What all transfers have in common, and the list of a folder."""

from collections.abc import Callable
from typing import Final, NamedTuple, Protocol

from companion.mavlink.ftp_frames import Code, Opcode, Reply
from mission_tools.station.ftp.asking import Asking
from mission_tools.station.words import LocalizedText, say

MOST_ENTRIES: Final = 4000
_REASONS: Final[dict[int, LocalizedText]] = {
    Code.INVALID_SESSION: say("file.closed"),
    Code.NO_SESSIONS_AVAILABLE: say("file.too_many_open"),
    Code.UNKNOWN_COMMAND: say("file.none"),
    Code.FILE_PROTECTED: say("file.protected"),
    Code.FILE_NOT_FOUND: say("file.not_found"),
}


class FtpFailure(NamedTuple):
    """Why a transfer has failed. text: for people. code: of the boat's refusal, 0 without one."""

    text: str
    code: int = 0


class Entry(NamedTuple):
    """In a folder. size: None of a folder."""

    name: str
    size: int | None


class Job:
    """A transfer, once it is the one under way.

    is_over: the next one may begin. is_yielded: it goes on later. is_paused: it waits for its reader.
    shall_yield: set while others wait.
    """

    is_over = is_yielded = is_paused = shall_yield = False

    def start(self, now_s: float) -> None:
        """Send the first request."""
        raise NotImplementedError

    def handle(self, reply: Reply, now_s: float) -> None:
        """A reply that answers none of the numbered requests."""

    def poll(self, now_s: float) -> None:
        """Go on, or give up; requests repeat themselves."""

    def cancel(self, now_s: float) -> None:
        """End; nothing is called back any more."""
        raise NotImplementedError

    def refuse(self, failure: FtpFailure) -> None:
        """It is not even begun."""
        raise NotImplementedError


class Sink(Protocol):
    """Where a file goes."""

    def begin(self, size: int) -> None:
        """A file begins, or begins anew. size: as the boat names it, in bytes."""

    def write(self, data: bytes) -> None:
        """What follows on the bytes so far."""

    def room(self) -> int:
        """Bytes that it takes now."""


def failure_of(reply: Reply | None) -> FtpFailure:
    """A NAK's error as a text for people."""
    if reply is None:
        return FtpFailure(say("file.no_answer"))
    return FtpFailure(_REASONS.get(reply.code) or say("file.error", n=reply.code), reply.code)


class Listing(Job):
    """A folder's entries. done: called once with them, or with why there are none."""

    def __init__(self, asking: Asking, path: str, done: Callable[[list[Entry] | FtpFailure], None]) -> None:
        self._asking = asking
        self._path = path.encode()
        self._done = done
        self._entries: list[Entry] = []
        self._count = 0  # of all lines, unreadable ones included

    def start(self, now_s: float) -> None:
        self._asking.ask(Opcode.LIST_DIRECTORY, self._on_page, now_s, offset=self._count, data=self._path)

    def cancel(self, now_s: float) -> None:  # noqa: ARG002
        self._asking.drop()
        self.is_over = True

    def refuse(self, failure: FtpFailure) -> None:
        self.is_over = True
        self._done(failure)

    def _on_page(self, reply: Reply | None, now_s: float) -> None:
        if reply is None or reply.code not in (0, Code.END_OF_FILE):
            self.refuse(failure_of(reply))
            return
        lines = [] if reply.code else [line for line in reply.data.split(b"\0") if line]
        self._count += len(lines)
        self._entries += [entry for line in lines if (entry := _entry_of(line)) is not None]
        if lines and self._count < MOST_ENTRIES:
            self.start(now_s)
            return
        self.is_over = True
        self._done(self._entries)


def _entry_of(line: bytes) -> Entry | None:
    """None for an entry that the boat does not show, or whose name is no plain file name."""
    kind, text = line[:1], line[1:].decode("utf-8", "replace")
    name, _, size = text.partition("\t")
    if not name.isprintable() or "/" in name or "\ufffd" in name or name in ("", ".", ".."):
        return None
    if kind == b"D":
        return Entry(name, None)
    if kind == b"F" and size.isascii() and size.isdigit() and len(size) <= 12:
        return Entry(name, int(size))
    return None
