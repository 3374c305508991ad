"""In which line of a TOML text a key stands: for complaints that name a key, such as `$.links[0].url`."""

import re
from collections.abc import Iterator
from typing import Final

Path = tuple[str | int, ...]

_MOST_LEVELS: Final = 32  # as companion.core.toml_text
_SYNTAX: Final = re.compile(r"\(at line (\d+), column \d+\)")
_AT: Final = re.compile(r" - at `\$((?:\.[^.`\[\]]+|\[[^\]`]*\])+)`")
_UNKNOWN: Final = re.compile(r"unknown field `([^`]+)`")
_LEADING: Final = re.compile(r"\s*([A-Za-z_][\w-]*(?:\[\d+\])?(?:\.[A-Za-z_][\w-]*(?:\[\d+\])?)*)(?=:| = )")
_PART: Final = re.compile(r"\.?([^.\[\]]+)|\[([^\]]*)\]")
_BLANK: Final = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_SPACE: Final = re.compile(r"[ \t]*")
_TEXT: Final = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'', re.DOTALL
)
_BARE: Final = re.compile(r"[A-Za-z0-9_-]+")
_SCALAR: Final = re.compile(r"[^,\]}#\r\n]*")


def line_of(complaint: str, text: str) -> int | None:
    """The line, from 1, that a complaint of the configuration is about; None where it names none."""
    if (syntax := _SYNTAX.search(complaint)) is not None:
        return int(syntax[1])
    if "(at end of document)" in complaint:
        return text.count("\n", 0, max(len(text) - 1, 0)) + 1
    wanted = _path_in(complaint)
    if not wanted:
        return None
    best, found = 0, None
    for path, line in _keys(text):
        shared = _shared(path, wanted)
        if shared > best and shared == len(path):
            best, found = shared, line
    return found


def _path_in(complaint: str) -> Path:
    """Of the table that the complaint ends with, and of the key that it begins with or does not know."""
    at, unknown = _AT.search(complaint), _UNKNOWN.search(complaint)
    path = _parts(at[1]) if at is not None else ()
    if unknown is not None:
        return (*path, unknown[1])
    leading = _LEADING.match(complaint)
    return path if leading is None else path + _parts(leading[1])


def _parts(dotted: str) -> Path:
    """[...] stands for any key of a table; the path ends before it."""
    parts: list[str | int] = []
    for part in _PART.finditer(dotted):
        if part[1] is not None:
            parts.append(part[1])
        elif part[2].isdigit():
            parts.append(int(part[2]))
        else:
            break
    return tuple(parts)


def _shared(one: Path, other: Path) -> int:
    """How many parts of the two are the same from the start."""
    count = 0
    for mine, theirs in zip(one, other, strict=False):
        if mine != theirs:
            break
        count += 1
    return count


def _keys(text: str) -> Iterator[tuple[Path, int]]:
    """Every key, table and element with its line. Ends where the text is no TOML."""
    walk = _Walk(text)
    try:
        yield from walk.document()
    except _EndError:
        return


class _EndError(Exception):
    """Not as expected."""


class _Walk:
    """A place in the text."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0
        self._line = 1
        self._lists: dict[Path, int] = {}

    def document(self) -> Iterator[tuple[Path, int]]:
        table: Path = ()
        while True:
            self._skip(_BLANK)
            if self._at >= len(self._text):
                return
            line = self._line
            if self._takes("[["):
                name = self._placed(self._key())
                number = self._lists[name] = self._lists.get(name, -1) + 1
                table = (*name, number)
                self._expect("]]")
                yield table, line
            elif self._takes("["):
                table = self._placed(self._key())
                self._expect("]")
                yield table, line
            else:
                yield from self._pair(table, 0)

    def _pair(self, table: Path, level: int) -> Iterator[tuple[Path, int]]:
        line = self._line
        path = (*table, *self._key())
        yield path, line
        self._expect("=")
        self._skip(_SPACE)
        yield from self._value(path, level)

    def _value(self, path: Path, level: int) -> Iterator[tuple[Path, int]]:
        if level > _MOST_LEVELS:
            raise _EndError
        if self._takes("["):
            yield from self._list(path, level)
        elif self._takes("{"):
            self._skip(_BLANK)
            while not self._takes("}"):
                yield from self._pair(path, level + 1)
                self._skip(_BLANK)
                self._takes(",")
                self._skip(_BLANK)
        elif self._skip(_TEXT) == 0 and self._skip(_SCALAR) == 0:
            raise _EndError

    def _list(self, path: Path, level: int) -> Iterator[tuple[Path, int]]:
        number = 0
        self._skip(_BLANK)
        while not self._takes("]"):
            yield (*path, number), self._line
            yield from self._value((*path, number), level + 1)
            number += 1
            self._skip(_BLANK)
            self._takes(",")
            self._skip(_BLANK)

    def _placed(self, name: Path) -> Path:
        """A header's name with the numbers of the lists of tables that it is in."""
        path: Path = ()
        for place, part in enumerate(name):
            path = (*path, part)
            if path in self._lists and place < len(name) - 1:
                path = (*path, self._lists[path])
        return path

    def _key(self) -> Path:
        parts: list[str] = []
        while True:
            self._skip(_SPACE)
            found = _BARE.match(self._text, self._at) or _TEXT.match(self._text, self._at)
            if found is None or len(parts) > _MOST_LEVELS:
                raise _EndError
            self._move(found.end())
            parts.append(found[0].strip("\"'"))
            self._skip(_SPACE)
            if not self._takes("."):
                return tuple(parts)

    def _takes(self, mark: str) -> bool:
        if not self._text.startswith(mark, self._at):
            return False
        self._at += len(mark)
        return True

    def _expect(self, mark: str) -> None:
        if not self._takes(mark):
            raise _EndError

    def _skip(self, pattern: re.Pattern[str]) -> int:
        """How many characters were skipped."""
        found = pattern.match(self._text, self._at)
        before = self._at
        if found is not None:
            self._move(found.end())
        return self._at - before

    def _move(self, to: int) -> None:
        self._line += self._text.count("\n", self._at, to)
        self._at = to
