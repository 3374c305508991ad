"""NMEA 0183 framing: bytes to sentences. Malformed input is counted, never raised."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from pynmeagps import NMEAReader
from pynmeagps.exceptions import NMEAMessageError, NMEAParseError, NMEAStreamError, NMEATypeError

LONGEST_SENTENCE = 256  # the standard says 82; some receivers exceed it
_FAULTS = (
    NMEAParseError,
    NMEATypeError,
    NMEAMessageError,
    NMEAStreamError,
    ValueError,
    IndexError,
    TypeError,
)


@dataclass(frozen=True, slots=True)
class Sentence:
    """A sentence with a valid checksum: its kind, such as GGA, and its fields by pynmeagps' names."""

    kind: str
    fields: Mapping[str, object]

    def number(self, name: str) -> float | None:
        """A numeric field, None if empty."""
        value = self.fields.get(name)
        return float(value) if isinstance(value, float | int) and math.isfinite(value) else None

    def text(self, name: str) -> str:
        """A text field, empty if missing."""
        return str(self.fields.get(name, ""))


class LineReader:
    """Splits a byte stream into lines. `malformed`: those with a fault, or too many bytes."""

    def __init__(self) -> None:
        self._held = b""
        self.malformed = 0

    def lines(self, data: bytes) -> list[bytes]:
        """The complete lines; a partial one is kept."""
        *lines, self._held = (self._held + data).split(b"\n")
        if len(self._held) > LONGEST_SENTENCE:
            self._held = b""
            self.malformed += 1
        return [line.rstrip() for line in lines]

    def forget(self) -> None:
        """Drop a partial line after a reconnect."""
        self._held = b""


class NmeaReader(LineReader):
    """Splits a byte stream into sentences and parses the wanted kinds.

    `malformed`: lines with a wrong checksum, wrong fields or too many bytes; `skipped`: sentences of other
    kinds, which are not parsed.
    """

    def __init__(self, wanted: frozenset[str]) -> None:
        super().__init__()
        self._wanted = wanted
        self.accepted = 0
        self.skipped = 0

    def want(self, kinds: frozenset[str]) -> None:
        """Parse these kinds too."""
        self._wanted |= kinds

    def feed(self, data: bytes) -> list[Sentence]:
        """Parse complete sentences; a partial one is kept."""
        sentences = map(self._parse, self.lines(data))
        return [sentence for sentence in sentences if sentence is not None]

    def _parse(self, line: bytes) -> Sentence | None:
        if not line:
            return None
        raw = line[max(line.rfind(b"$"), 0) :]  # a truncated sentence may precede a whole one
        if raw[:1] != b"$" or raw[-3:-2] != b"*" or len(raw) > LONGEST_SENTENCE:
            self.malformed += 1
            return None
        if raw[3:6].decode("ascii", "replace") not in self._wanted:
            self.skipped += 1
            return None
        try:
            message = NMEAReader.parse(raw + b"\r\n")
        except _FAULTS:
            message = None
        if message is None:
            self.malformed += 1
            return None
        self.accepted += 1
        fields = {name: value for name, value in vars(message).items() if not name.startswith("_")}
        return Sentence(message.msgID, fields)
