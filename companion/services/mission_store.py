"""The boat's lists on disk: one JSON file for each of mission, fence and rally, a line an item."""

import json
import logging
from collections.abc import Iterable

from companion.mavlink.items import MissionItem, MissionType
from companion.storage import Saving, Storage

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


def load_items(storage: Storage, mission_type: MissionType) -> tuple[MissionItem, ...]:
    """The list last saved; empty, with a warning, where the file is no list of ours."""
    content = storage.load(_file(mission_type))
    if not content:
        return ()
    try:
        tree = json.loads(content)
        version, entries = tree["version"], tree["items"]
        items = tuple(MissionItem.from_dict(entry) for entry in entries)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        logger.warning("%s ignored: %s", _file(mission_type), error)
        return ()
    if version != _VERSION:
        logger.warning("%s ignored: version %s, expected %s", _file(mission_type), version, _VERSION)
        return ()
    return items
