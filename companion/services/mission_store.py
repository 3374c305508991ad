"""The boat's lists on disk: one JSON file for each of mission, fence and rally."""

import json
import logging
from collections.abc import Sequence

from companion.mavlink.items import MissionItem, MissionType
from companion.storage import Saving, Storage

logger = logging.getLogger(__name__)

_VERSION = 1


def _file(mission_type: MissionType) -> str:
    return f"{mission_type.name.lower()}.json"


def save_items(storage: Storage, mission_type: MissionType, items: Sequence[MissionItem]) -> Saving:
    """Begin to replace a list on the medium."""
    tree = {"version": _VERSION, "items": [item.to_dict() for item in items]}
    return storage.save(_file(mission_type), json.dumps(tree, allow_nan=False, indent=0).encode("ascii"))


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
