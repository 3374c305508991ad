"""Highest timestamp proven per signing key, to reject replayed frames.

A key that returns after another one (A, B, A) must not make recorded frames valid. The highest proven
timestamp of each key is stored with a tag of the key. For keys displaced from the table, the highest of their
timestamps applies to every key that is not in it.
"""

from collections import OrderedDict
from typing import Any

from companion.mavlink.signing import NEVER
from companion.mavlink.signing_key import SigningKey

MAX_KEYS = 16


class KeyFloors:
    """A frame must be newer than the floor of its key. others: the floor of keys not in the table."""

    def __init__(self, floors: dict[str, int] | None = None, others: int = 0) -> None:
        self._floors = OrderedDict(floors or {})
        self._others = others

    def of(self, key: SigningKey | None) -> int:
        """The floor of a key, 0 without a key."""
        return 0 if key is None else self._floors.get(key.tag, self._others)

    def record(self, key: SigningKey | None, timestamp: int) -> None:
        """Record a proven timestamp."""
        if key is None:
            return
        self._floors[key.tag] = max(timestamp, self.of(key))
        self._floors.move_to_end(key.tag)
        while len(self._floors) > MAX_KEYS:
            _, floor = self._floors.popitem(last=False)
            self._others = max(self._others, floor)

    def to_tree(self) -> dict[str, Any]:
        """For the file."""
        return {"keys": dict(self._floors), "others": self._others}

    @classmethod
    def from_tree(cls, tree: Any, seen: int) -> "KeyFloors":  # noqa: ANN401
        """From the file; earlier versions store one timestamp for all keys, `seen`.

        Raises:
            KeyError, TypeError, ValueError: invalid content.
        """
        if tree is None:
            return cls(others=seen)
        floors, others = dict(tree["keys"]), tree["others"]
        if not all(isinstance(stamp, int) and 0 <= stamp < NEVER for stamp in (*floors.values(), others)):
            raise ValueError("no timestamps by key in it")
        return cls(floors, others)
