"""Who may ask the boat for something: whoever has told the PIN, until the session ends."""

import asyncio
import hashlib
import secrets
from collections import OrderedDict
from typing import Final, NamedTuple

from companion.core.errors import StorageError
from companion.shore.messages import Role
from companion.shore.web.pin_file import MOST_CHARACTERS, PinFile, is_pin
from companion.shore.web.throttle import Throttle
from companion.shore.words import say

LIFE_S: Final = 12 * 3600.0  # a day at the water
_MOST_SESSIONS: Final = 32
READ_ONLY: Final = say("pin.unset")
VIEWER: Final = say("pin.first")


class Opened(NamedTuple):
    """token: the cookie's value."""

    token: str


class Refused(NamedTuple):
    """wait_s: until the next try; None: not a matter of time."""

    text: str
    wait_s: float | None = None
    is_held_up: bool = False  # the PIN was not even looked at


class _Session(NamedTuple):
    line: str  # of the PIN file when it was opened
    until_s: float


class Sessions:
    """Open sessions by the hash of their token. They do not outlive the program."""

    def __init__(self, pin: PinFile) -> None:
        self._pin = pin
        self._throttle = Throttle()
        self._open: OrderedDict[bytes, _Session] = OrderedDict()
        self._check = asyncio.Lock()  # one hash at a time: each takes 8 MB

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

    async def open(self, pin: str, address: str, now_s: float) -> Opened | Refused:
        """Check a PIN, in a thread."""
        line, why = self._line()
        if line is None:
            return Refused(why)
        wait_s = self._throttle.wait_s(address, now_s)
        if wait_s > 0.0:
            return Refused(say("pin.wait", n=round(wait_s)), wait_s, is_held_up=True)
        self._throttle.begin(address, now_s)
        async with self._check:
            is_right = len(pin) <= MOST_CHARACTERS and await asyncio.to_thread(is_pin, pin, line)
        if not is_right:
            return Refused(say("pin.wrong"), self._throttle.wait_s(address, now_s))
        self._throttle.succeed(address)
        token = secrets.token_urlsafe(16)
        self._open[_key(token)] = _Session(line, now_s + LIFE_S)
        if len(self._open) > _MOST_SESSIONS:
            self._open.popitem(last=False)
        return Opened(token)

    def is_known(self, address: str) -> bool:
        """Whether an address has told the PIN since the program began."""
        return self._throttle.is_known(address)

    def role(self, token: str | None, now_s: float) -> Role:
        """Of the owner of a cookie."""
        session = self._open.get(_key(token)) if token else None
        if session is None or now_s >= session.until_s or session.line != self._line()[0]:
            return "viewer"
        return "skipper"

    def close(self, token: str | None) -> None:
        """End a session."""
        if token:
            self._open.pop(_key(token), None)


def _key(token: str) -> bytes:
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).digest()
