"""STATUSTEXT: chunks joined, the latest lines kept."""

from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from companion.mavlink.dialect import Message
from mission_tools.station.messages import TextLine
from mission_tools.station.view import clean

_KEPT = 30
_CHUNK_BYTES = 50
_MOST_CHUNKS = 10  # the boat's texts have at most four
_MOST_OPEN = 8
_PATIENCE_S = 1.0  # for the chunks that are missing


class Text(NamedTuple):
    """A STATUSTEXT put together from its chunks."""

    severity: int
    text: str


class _Chunked(NamedTuple):
    severity: int
    began_s: float
    chunks: dict[int, str]


class Texts:
    """Joins chunks, and numbers the lines of what is news."""

    def __init__(self, is_news: Callable[[Text], bool]) -> None:
        self._is_news = is_news
        self.lines: deque[TextLine] = deque(maxlen=_KEPT)
        self._open: dict[int, _Chunked] = {}
        self._number = 0

    def ingest(self, message: Message, now_s: float, unix_s: float) -> list[Text]:
        """The texts that this message completes."""
        raw = str(message.text)
        if not message.id:
            return self._complete([Text(message.severity, clean(raw))], unix_s)
        part = self._open.get(message.id)
        if part is None:
            if len(self._open) >= _MOST_OPEN:
                return []
            part = self._open[message.id] = _Chunked(message.severity, now_s, {})
        if message.chunk_seq >= _MOST_CHUNKS:
            return []
        part.chunks[message.chunk_seq] = raw
        ends = [n for n, chunk in part.chunks.items() if "\0" in chunk or len(chunk) < _CHUNK_BYTES]
        if not ends or any(number not in part.chunks for number in range(min(ends) + 1)):
            return []
        del self._open[message.id]
        return self._complete([_joined(part)], unix_s)

    def poll(self, now_s: float, unix_s: float) -> list[Text]:
        """The texts whose missing chunks no longer come, as far as they came."""
        late = [number for number, part in self._open.items() if now_s - part.began_s >= _PATIENCE_S]
        return self._complete([_joined(self._open.pop(number)) for number in late], unix_s)

    def _complete(self, texts: list[Text], unix_s: float) -> list[Text]:
        told = [text for text in texts if text.text]
        for text in filter(self._is_news, told):
            self._number += 1
            line = TextLine(number=self._number, at_s=unix_s, severity=text.severity, text=text.text)
            self.lines.append(line)
        return told


def _joined(part: _Chunked) -> Text:
    text = "".join(chunk.split("\0", 1)[0] for _, chunk in sorted(part.chunks.items()))
    return Text(part.severity, clean(text))
