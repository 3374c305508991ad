"""How far each signing key has been used, so that what was signed with it once is not believed again.

A key that is replaced and comes back later (A, B, A) must not make recorded frames valid. So the highest
timestamp that was proved under each key is kept with a tag of the key, over restarts. Of keys that are
displaced from the table, the highest timestamp holds for every key that is not in it.
"""

from collections import OrderedDict
from typing import Any

from companion.mavlink.signing import NEVER
from companion.mavlink.signing_key import SigningKey

MAX_KEYS = 16


class KeyFloors:
    """A frame must be newer than the floor of its key. others: the floor of keys that are not in the
    table.
    """

    def __init__(self, floors: dict[str, int] | None = None, others: int = 0) -> None:
        self._floors = OrderedDict(floors or {})
        self._others = others

    def of(self, key: SigningKey | None) -> int:
        """The floor of a key, 0 where there is no key."""
        return 0 if key is None else self._floors.get(key.tag, self._others)

    def record(self, key: SigningKey | None, timestamp: int) -> None:
        """A timestamp was proved under a key."""
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
        """As the file has it; files of earlier versions hold one timestamp for all keys, `seen`.

        Raises:
            KeyError, TypeError, ValueError: it is no such tree.
        """
        if tree is None:
            return cls(others=seen)
        floors, others = dict(tree["keys"]), tree["others"]
        if not all(isinstance(stamp, int) and 0 <= stamp < NEVER for stamp in (*floors.values(), others)):
            raise ValueError("no timestamps by key in it")
        return cls(floors, others)
