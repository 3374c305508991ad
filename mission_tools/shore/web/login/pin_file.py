"""The PIN's hash in a file that only its owner reads."""

import hashlib
import hmac
import secrets
from pathlib import Path
from typing import Final

from companion.core.errors import ConfigError, OutputError, StorageError
from companion.core.generations import write_atomically

LEAST_CHARACTERS: Final = 6
MOST_CHARACTERS: Final = 64
_COST: Final = 2**13  # with 8 blocks: 8 MB; two rounds: about 0.05 s on a laptop, 0.3 s on a Pi Zero 2
_BLOCKS: Final = 8
_ROUNDS: Final = 2
_HEAD: Final = f"scrypt {_COST} {_BLOCKS} {_ROUNDS}"


def check_pin(pin: str) -> None:
    """Refuse what is too short or of one character, by a ConfigError that says what is expected."""
    if not LEAST_CHARACTERS <= len(pin) <= MOST_CHARACTERS or not pin.isprintable():
        raise ConfigError(f"expected a PIN of {LEAST_CHARACTERS} to {MOST_CHARACTERS} digits or letters")
    if len(set(pin)) == 1:
        raise ConfigError("expected a PIN of more than one digit or letter")


def hashed(pin: str, salt: bytes | None = None) -> str:
    """The line of the file."""
    salt = secrets.token_bytes(16) if salt is None else salt
    key = hashlib.scrypt(pin.encode(), salt=salt, n=_COST, r=_BLOCKS, p=_ROUNDS, maxmem=2**26, dklen=32)
    return f"{_HEAD} {salt.hex()} {key.hex()}"


def is_pin(pin: str, line: str) -> bool:
    """Whether a PIN is that of a line; takes as long for a wrong one."""
    salt = bytes.fromhex(line.split()[4])
    return hmac.compare_digest(hashed(pin, salt), line)


class PinFile:
    """Read again when it changes, so that `boat-shore pin` takes effect at once."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._stamp: tuple[int, int, int] | None = None
        self._line: str | None = None

    def line(self) -> str | None:
        """The hash; None while no PIN is set. StorageError if the file is damaged, or readable by others."""
        try:
            stat = self.path.stat()
        except FileNotFoundError:
            self._stamp = self._line = None
            return None
        except OSError as error:
            raise StorageError(f"{self.path}: cannot be read: {error.strerror}") from None
        stamp = (stat.st_ino, stat.st_mtime_ns, stat.st_mode)
        if stamp != self._stamp:
            self._line = self._read(stat.st_mode)
            self._stamp = stamp
        return self._line

    def _read(self, mode: int) -> str:
        if mode & 0o077:
            raise StorageError(f"{self.path}: others may read it: chmod 600 {self.path}")
        try:
            line = self.path.read_text(encoding="ascii").strip()
        except (OSError, ValueError):
            raise StorageError(f"{self.path}: cannot be read: set the PIN again: boat-shore pin") from None
        words = line.split()
        is_whole = (
            len(words) == 6 and " ".join(words[:4]) == _HEAD and len(words[4]) == 32 and len(words[5]) == 64
        )
        if not is_whole or set(words[4] + words[5]) - set("0123456789abcdef"):
            raise StorageError(f"{self.path}: is damaged: set the PIN again: boat-shore pin")
        return line

    def write(self, pin: str) -> None:
        """Set the PIN. Sessions of another one end. ConfigError: too simple; OutputError: not written."""
        check_pin(pin)
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            write_atomically(self.path, f"{hashed(pin)}\n".encode("ascii"), is_private=True)
        except OSError as error:
            raise OutputError.of(self.path, error) from None
