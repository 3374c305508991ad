"""What one viewer of one boat gets: the newest state as a difference to the one sent before, never a queue.

A sent state is acknowledged by the pong of a ping sent behind it. A viewer with UNACKNOWLEDGED states on the
way gets no further one until a pong comes; the next difference then covers all that changed meanwhile.
"""

from collections import deque
from typing import Any, Final

import msgspec

from mission_tools.station.messages import Answer, Hello, Snapshot, State, ToPage
from mission_tools.station.words import LocalizedText

Tree = dict[str, Any]  # as JSON, without None: a key that is missing is a value that is not known

UNACKNOWLEDGED: Final = 3
QUIET_S: Final = 2.0  # something is sent at least this often, so that the page knows of a broken link
LOST_S: Final = 30.0  # without a pong
MOST_ANSWERS: Final = 64


def tree_of(snapshot: Snapshot) -> Tree:
    """A snapshot as JSON's types; a list is one value, and keeps its Nones."""
    tree = _without_none(msgspec.to_builtins(snapshot))
    assert isinstance(tree, dict)  # noqa: S101 (a Struct is an object)
    return tree


def _without_none(value: Tree) -> Tree:
    return {
        key: _without_none(one) if isinstance(one, dict) else one
        for key, one in value.items()
        if one is not None
    }


def difference(old: Tree, new: Tree) -> Tree:
    """The patch that makes `new` of `old`; empty if they are the same."""
    patch: Tree = dict.fromkeys(key for key in old if key not in new)
    for key, value in new.items():
        before = old.get(key)
        if isinstance(value, dict) and isinstance(before, dict):
            inner = difference(before, value)
            if inner:
                patch[key] = inner
        elif before != value or key not in old:
            patch[key] = value
    return patch


def encode(message: ToPage) -> str:
    """As the page reads it."""
    return msgspec.json.encode(message, enc_hook=_as_json).decode()


def _as_json(value: object) -> object:
    if isinstance(value, LocalizedText):
        return value.to_page()
    raise TypeError(f"no JSON of {type(value).__name__}")


class Feed:
    """The latest state of one boat, shared by its viewers."""

    def __init__(self, boat: int) -> None:
        self.boat = boat
        self.tree: Tree | None = None
        self.version = 0
        self._step = ""  # from the version before; encoded once for all

    def update(self, snapshot: Snapshot | None) -> None:
        """Take a new snapshot."""
        if snapshot is None:
            return
        tree = tree_of(snapshot)
        patch = difference(self.tree or {}, tree)
        if patch or self.tree is None:
            self._step = encode(State(boat=self.boat, patch=patch))
            self.tree = tree
            self.version += 1

    def since(self, version: int, tree: Tree) -> str:
        """The patch from a version and its tree to the newest."""
        if version == self.version - 1:
            return self._step
        return encode(State(boat=self.boat, patch=difference(tree, self.tree or {})))


class Viewer:
    """What one socket has been sent, and what it waits for."""

    def __init__(self, feed: Feed | None, now_s: float) -> None:
        self.feed = feed
        self.hello: Hello | None = None
        self._is_greeted = False
        self._answers: deque[Answer] = deque()
        self._version = 0
        self._tree: Tree = {}
        self._on_the_way = 0
        self._heard_s = now_s  # a pong, or nothing was on the way
        self._sent_s = now_s

    def greet(self, hello: Hello) -> None:
        """Send a greeting, if it is new."""
        if not _is_same(self.hello, hello):
            self._is_greeted = False
        self.hello = hello

    def reply(self, answer: Answer) -> None:
        """Queue an answer for this socket."""
        self._answers.append(answer)

    def on_pong(self, now_s: float) -> None:
        """The viewer has read a state."""
        self._on_the_way = max(self._on_the_way - 1, 0)
        self._heard_s = now_s

    def is_lost(self, now_s: float) -> bool:
        """Whether it reads nothing."""
        return len(self._answers) > MOST_ANSWERS or (self._on_the_way > 0 and now_s - self._heard_s > LOST_S)

    def take(self, now_s: float) -> tuple[list[str], bool]:
        """Texts to send now, and whether a ping follows them."""
        texts: list[str] = []
        if not self._is_greeted and self.hello is not None:
            texts.append(encode(self.hello))
            self._is_greeted = True
        while self._answers:
            texts.append(encode(self._answers.popleft()))
        state = self._state(is_quiet=not texts and now_s - self._sent_s >= QUIET_S)
        if state is not None:
            if self._on_the_way == 0:
                self._heard_s = now_s
            self._on_the_way += 1
            texts.append(state)
        if texts:
            self._sent_s = now_s
        return texts, state is not None

    def _state(self, *, is_quiet: bool) -> str | None:
        if self._on_the_way >= UNACKNOWLEDGED:
            return None
        feed = self.feed
        if feed is None or feed.tree is None:
            return encode(self.hello) if is_quiet and self.hello is not None else None
        if feed.version == self._version:
            return encode(State(boat=feed.boat, patch={})) if is_quiet else None
        text = feed.since(self._version, self._tree)
        self._version, self._tree = feed.version, feed.tree
        return text


def _is_same(one: Hello | None, other: Hello) -> bool:
    """But for when the boats were heard."""
    if one is None:
        return False
    return one.role == other.role and [boat.id for boat in one.boats] == [boat.id for boat in other.boats]
