"""Who may ask the boat for something: whoever has told the PIN, until the session ends."""

import asyncio
import contextlib
import hashlib
import os
import secrets
from collections import OrderedDict
from pathlib import Path
from typing import Final, NamedTuple

import msgspec

from companion.core.errors import StorageError
from companion.core.generations import write_atomically
from mission_tools.shore.clock import Clock
from mission_tools.shore.web.connections.throttle import Throttle
from mission_tools.shore.web.login.pin_file import MOST_CHARACTERS, PinFile, is_pin
from mission_tools.station.messages import Role
from mission_tools.station.words import say

LIFE_S: Final = 12 * 3600.0  # a day at the water
MOST_WAITING: Final = 64
_MOST_SESSIONS: Final = 32
READ_ONLY: Final = say("pin.unset")
VIEWER: Final = say("pin.first")


class LoginRefused(NamedTuple):
    """wait_s: until the next try; None: not a matter of time."""

    text: str
    wait_s: float | None = None
    is_held_up: bool = False  # the PIN was not even looked at


class _Session(NamedTuple):
    pin: str  # hash of the PIN file's line when it was opened
    until_s: float
    address: str


class _Try(NamedTuple):
    """A PIN that waits for its turn."""

    rank: int
    pin: str
    is_right: asyncio.Future[bool | None]  # None: it gives way


class _StoredSession(msgspec.Struct, frozen=True):
    """In a file: it outlasts the program. key: hash of the token. pin: hash of the PIN file's line."""

    key: str
    pin: str
    until_unix_s: float
    address: str


class Sessions:
    """Open sessions by the hash of their token. With a clock they outlast the program, in a file."""

    def __init__(self, pin: PinFile, clock: Clock | None = None) -> None:
        self._pin = pin
        self._clock = clock
        self._file = pin.path.with_name(f"{pin.path.name}-sessions")
        self._throttle = Throttle()
        self._open: OrderedDict[str, _Session] = OrderedDict()
        self._waiting: list[_Try] = []
        self._check: asyncio.Task[None] | None = None  # one at a time: each takes 8 MB
        self._next_s = float("-inf")
        if clock is not None:
            self._restore(clock)

    def _restore(self, clock: Clock) -> None:
        now_s, unix_s = clock.now_s(), clock.unix_s()
        for one in _read(self._file)[-_MOST_SESSIONS:]:
            left_s = min(one.until_unix_s - unix_s, LIFE_S)  # the date may have gone back
            self._open[one.key] = _Session(one.pin, now_s + left_s, one.address)
            self._throttle.succeed(one.address)

    def _store(self) -> None:
        if self._clock is None:
            return
        ahead_s = self._clock.unix_s() - self._clock.now_s()
        stored = [
            _StoredSession(key, one.pin, one.until_s + ahead_s, one.address)
            for key, one in self._open.items()
        ]
        with contextlib.suppress(OSError):  # the PIN opens a session again
            write_atomically(self._file, msgspec.json.encode(stored), is_private=True)

    def refusal(self) -> str:
        """Why a viewer's request is refused."""
        return self._line()[1] or VIEWER

    def _line(self) -> tuple[str | None, str]:
        """The PIN file's line, or None and why there is none."""
        try:
            line = self._pin.line()
        except StorageError as error:
            return None, str(error)
        return line, "" if line is not None else READ_ONLY

    @property
    def has_pin(self) -> bool:
        """Whether a PIN is set."""
        return self._line()[0] is not None

    async def open(self, pin: str, address: str, now_s: float) -> str | LoginRefused:
        """Check a PIN when its turn comes, in a thread; the token of a new session."""
        line, why = self._line()
        if line is None:
            return LoginRefused(why)
        wait_s = self._throttle.wait_s(address, now_s)
        if wait_s > 0.0:
            return LoginRefused(say("pin.wait", n=round(wait_s)), wait_s, is_held_up=True)
        one = _Try(self._throttle.rank(address, now_s), pin, asyncio.get_running_loop().create_future())
        self._throttle.begin(address, now_s)
        self._waiting.append(one)
        if len(self._waiting) > MOST_WAITING:  # the latest of those that have failed most often gives way
            last = max(reversed(self._waiting), key=lambda waiting: waiting.rank)
            self._waiting.remove(last)
            last.is_right.set_result(None)
        self.poll(now_s)
        try:
            is_right = await one.is_right
        finally:
            if one in self._waiting:  # the browser has left
                self._waiting.remove(one)
        if is_right is None:
            return LoginRefused(say("pin.busy"), 1.0, is_held_up=True)
        if not is_right:
            return LoginRefused(say("pin.wrong"), self._throttle.wait_s(address, now_s))
        self._throttle.succeed(address)
        token = secrets.token_urlsafe(16)
        self._open[_hash(token)] = _Session(_hash(line), now_s + LIFE_S, address)
        if len(self._open) > _MOST_SESSIONS:
            self._open.popitem(last=False)
        self._store()
        return token

    def poll(self, now_s: float) -> None:
        """Look at the next PIN, if it is time. Call it every 50 ms."""
        if self._check is not None or not self._waiting or now_s < self._next_s:
            return
        one = min(self._waiting, key=lambda waiting: waiting.rank)
        self._waiting.remove(one)
        self._check = asyncio.get_running_loop().create_task(self._look_at(one, now_s))

    async def _look_at(self, one: _Try, now_s: float) -> None:
        line, _ = self._line()
        is_right = (
            line is not None
            and len(one.pin) <= MOST_CHARACTERS
            and await asyncio.to_thread(is_pin, one.pin, line)
        )
        self._check = None
        if not is_right:
            self._throttle.fail(now_s)
            self._next_s = now_s + self._throttle.pace_s(now_s)
        if not one.is_right.done():
            one.is_right.set_result(is_right)
        self.poll(now_s)

    def is_known(self, address: str) -> bool:
        """Whether an address has told the PIN since the program began, or has a session from before."""
        return self._throttle.is_known(address)

    def role(self, token: str | None, now_s: float) -> Role:
        """Of the owner of a cookie."""
        session = self._open.get(_hash(token)) if token else None
        line, _ = self._line()
        if session is None or now_s >= session.until_s or line is None or session.pin != _hash(line):
            return "viewer"
        return "skipper"

    def close(self, token: str | None) -> None:
        """End the session of a token."""
        if token and self._open.pop(_hash(token), None) is not None:
            self._store()


def _read(path: Path) -> list[_StoredSession]:
    """The oldest first; a file that is missing, damaged or open to others holds no sessions."""
    try:
        with path.open("rb") as file:
            if os.fstat(file.fileno()).st_mode & 0o077:
                return []
            return msgspec.json.decode(file.read(), type=list[_StoredSession])
    except (OSError, msgspec.MsgspecError, UnicodeError):
        return []


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()
