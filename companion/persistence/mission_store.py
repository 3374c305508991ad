"""Storage of the lists: one JSON file for each of mission, fence and rally, one item per line."""

import json
import logging
from collections.abc import Iterable
from typing import Final, NamedTuple

from companion.core.storage import Saving, Storage
from companion.mavlink.items import MissionItem, MissionType

logger = logging.getLogger(__name__)

FENCE: Final = "fence"
FIRST_S: Final = 5.0  # since boot, as for PreArm reports: stations need time to connect
REPEAT_S: Final = 30.0
_VERSION = 1


def _file(mission_type: MissionType) -> str:
    return f"{mission_type.name.lower()}.json"


def encode_item(item: MissionItem) -> bytes:
    """The line of an item. Encoded on arrival, so that no tick encodes a whole list."""
    return json.dumps(item.to_dict(), allow_nan=False).encode("ascii")


def save_lines(storage: Storage, mission_type: MissionType, lines: Iterable[bytes]) -> Saving:
    """Start replacing a list by these lines."""
    content = b'{"version": %d, "items": [\n%s\n]}\n' % (_VERSION, b",\n".join(lines))
    return storage.save(_file(mission_type), content)


class StoredList(NamedTuple):
    """A loaded list. loss: what of it is lost, and what is used instead; empty if intact."""

    items: tuple[MissionItem, ...]
    loss: str


def load_items(storage: Storage, mission_type: MissionType) -> StoredList:
    """The stored list; empty, with a loss, if the file is invalid."""
    name = _file(mission_type)
    content = storage.load(name)
    loss = storage.damage(name)
    if not content:
        return StoredList((), loss)
    try:
        return StoredList(_parse(content), loss)
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError) as error:
        logger.warning("%s ignored: %s", name, error)
        return StoredList((), f"{name} cannot be read, none is in use")


def _parse(content: bytes) -> tuple[MissionItem, ...]:
    tree = json.loads(content)
    version, entries = tree["version"], tree["items"]
    if version != _VERSION:
        raise ValueError(f"version {version}, expected {_VERSION}")
    return tuple(MissionItem.from_dict(entry) for entry in entries)


class DataLosses:
    """A message for each list found damaged at the start, by name; repeated until it is replaced."""

    def __init__(self) -> None:
        self._texts: dict[str, str] = {}
        self._due_s = FIRST_S

    def add(self, name: str, what: str, remedy: str) -> None:
        """Add a lost list. what: the damage, and what is used instead; remedy: what ends the report."""
        self._texts[name] = f"{name[0].upper()}{name[1:]} lost: {what}. {remedy}"

    def end(self, name: str) -> None:
        """The list was replaced."""
        self._texts.pop(name, None)

    def text(self, name: str) -> str:
        """The message about a list; empty if it is not lost."""
        return self._texts.get(name, "")

    def update(self, now_s: float) -> list[str]:
        """The messages due now."""
        if not self._texts or now_s < self._due_s:
            return []
        self._due_s = now_s + REPEAT_S
        return list(self._texts.values())
