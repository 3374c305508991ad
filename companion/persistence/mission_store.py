"""The boat's lists on disk: one JSON file for each of mission, fence and rally, a line an item."""

import json
import logging
from collections.abc import Iterable
from typing import NamedTuple

from companion.mavlink.items import MissionItem, MissionType
from companion.persistence.storage import Saving, Storage

logger = logging.getLogger(__name__)

_VERSION = 1


def _file(mission_type: MissionType) -> str:
    return f"{mission_type.name.lower()}.json"


def encode_item(item: MissionItem) -> bytes:
    """An item's line. Made as the item arrives, so that no tick has to wait for a whole list."""
    return json.dumps(item.to_dict(), allow_nan=False).encode("ascii")


def save_lines(storage: Storage, mission_type: MissionType, lines: Iterable[bytes]) -> Saving:
    """Begin to replace a list on the medium by the lines of its items."""
    content = b'{"version": %d, "items": [\n%s\n]}\n' % (_VERSION, b",\n".join(lines))
    return storage.save(_file(mission_type), content)


def save_items(storage: Storage, mission_type: MissionType, items: Iterable[MissionItem]) -> Saving:
    """Begin to replace a list on the medium."""
    return save_lines(storage, mission_type, [encode_item(item) for item in items])


class StoredList(NamedTuple):
    """A list from the medium. loss: what of it is lost, and what is in use instead; empty if nothing is."""

    items: tuple[MissionItem, ...]
    loss: str


def load_items(storage: Storage, mission_type: MissionType) -> StoredList:
    """The list last saved; empty, with a loss, where the file is no list of ours."""
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
