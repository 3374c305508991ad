"""The secret shared by two ends of a signed link, and its file.

A key file is accessible to its owner only (mode 0600) and contains one of

    32 bytes            the key itself
    64 hex digits       the key in hexadecimal
    a line of text      a passphrase; the key is its SHA-256, as in MAVProxy and QGroundControl

A line of text is never taken as 32 raw bytes. It may follow a comment line starting with `# `: the boat's own
file has its checksum there.
"""

import hashlib
import hmac
import os
from pathlib import Path

from companion.core.errors import ConfigError

KEY_BYTES = 32
SIGNATURE_BYTES = 6
_LONGEST_FILE = 4096
_FORMS = "expected 32 bytes, 64 hexadecimal digits, or one line with a passphrase"


class SigningKey:
    """A 32-byte secret. repr, str and format do not show it.
    Raises ValueError: not 32 bytes, or all zero, which on the wire means "no key".
    """

    __slots__ = ("_secret",)

    def __init__(self, secret: bytes) -> None:
        if len(secret) != KEY_BYTES or not any(secret):
            raise ValueError(f"a signing key has {KEY_BYTES} bytes, not all of them zero")
        self._secret = bytes(secret)

    @classmethod
    def from_passphrase(cls, passphrase: str) -> "SigningKey":
        return cls(hashlib.sha256(passphrase.encode()).digest())

    def signature(self, signed: bytes) -> bytes:
        """The 48-bit signature of these bytes."""
        return hashlib.sha256(self._secret + signed).digest()[:SIGNATURE_BYTES]

    @property
    def tag(self) -> str:
        """Identifies the key in a file without revealing more than a signed frame does."""
        return hashlib.sha256(b"mavboat signing key tag" + self._secret).hexdigest()[:16]

    def reveal(self) -> bytes:
        """The secret, for storage."""
        return self._secret

    def __repr__(self) -> str:
        return "SigningKey(hidden)"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SigningKey) and hmac.compare_digest(self._secret, other._secret)

    def __hash__(self) -> int:
        return hash(self._secret)

    def __reduce__(self) -> str:
        raise TypeError("a signing key is not pickled")


def read_key_file(path: Path) -> SigningKey:
    """The key in a file.
    Raises ConfigError: no such file, accessible to others, or without a key; says what to do.
    """
    try:
        with path.open("rb") as file:
            mode = os.fstat(file.fileno()).st_mode & 0o777
            content = file.read(_LONGEST_FILE + 1)
    except OSError as error:
        raise ConfigError(f"{path}: the signing key cannot be read: {error.strerror}") from None
    if mode & 0o077:
        raise ConfigError(f"{path}: mode {mode:04o} lets others at the signing key: chmod 600 {path}")
    try:
        return parse_key(content)
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from None


def parse_key(content: bytes) -> SigningKey:
    """The key in a file's content. Raises ValueError: no key; reports only the length of the content."""
    comment, _, rest = content.partition(b"\n")
    if comment.startswith(b"# ") and rest and len(content) != KEY_BYTES:
        content = rest
    text = _as_line(content)
    if text is None:
        if len(content) != KEY_BYTES:
            size = "more than 4096" if len(content) > _LONGEST_FILE else str(len(content))
            raise ValueError(f"no signing key in these {size} bytes; {_FORMS}")
        return SigningKey(content)
    if not text:
        raise ValueError(f"no signing key: the file is empty; {_FORMS}")
    if len(text) > KEY_BYTES and all(digit in "0123456789abcdefABCDEF" for digit in text):
        if len(text) != 2 * KEY_BYTES:
            raise ValueError(f"no signing key: {len(text)} hexadecimal digits; {_FORMS}")
        return SigningKey(bytes.fromhex(text))
    return SigningKey.from_passphrase(text)


def _as_line(content: bytes) -> str | None:
    """The content as one line of text, or None."""
    if len(content) > _LONGEST_FILE:
        return None
    try:
        text = content.decode().removesuffix("\n").removesuffix("\r")
    except UnicodeDecodeError:
        return None
    return text if text.isprintable() else None
