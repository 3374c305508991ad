import logging

import pytest
from boat_rig import HOME_ITEM, waypoint
from hypothesis import given
from hypothesis import strategies as st

from companion.core.storage import MemoryStorage
from companion.mavlink.items import MissionItem, MissionType
from companion.persistence.mission_store import load_items, save_items

ITEMS = (HOME_ITEM, waypoint(10.0, 20.0, param1=float("inf")), waypoint(-1.0, 2.5))


@pytest.mark.parametrize("kind", list(MissionType))
def test_a_list_is_loaded_as_it_was_saved_nan_and_infinity_included(kind: MissionType) -> None:
    storage = MemoryStorage()
    assert save_items(storage, kind, ITEMS).is_done()
    assert load_items(storage, kind) == (ITEMS, "")
    assert list(storage.content) == [f"{kind.name.lower()}.json"]


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"[]",
        b"null",
        b"\xff\xfe",
        b'{"version": 1}',
        b'{"version": 1, "items": 7}',
        b'{"version": 1, "items": [7]}',
        b'{"version": 1, "items": [{"frame": 3}]}',
        b'{"version": 2, "items": []}',
        b"[" * 100_000,
        b'{"version": 1, "items": [{"frame": %s}]}' % (b"9" * 5000),
    ],
)
def test_a_file_that_is_no_list_of_ours_is_an_empty_list_and_a_warning(
    content: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    storage = MemoryStorage()
    storage.content["fence.json"] = content
    with caplog.at_level(logging.WARNING):
        items, loss = load_items(storage, MissionType.FENCE)
    assert items == ()
    assert bool(content) == ("fence.json cannot be read" in loss)
    assert bool(content) == any("fence.json ignored" in record.getMessage() for record in caplog.records)


whole = MemoryStorage()
save_items(whole, MissionType.MISSION, ITEMS)
SAVED = whole.content["mission.json"]


@given(st.integers(0, len(SAVED) - 1), st.binary(min_size=1, max_size=3))
def test_a_damaged_file_never_raises(at: int, damage: bytes) -> None:
    storage = MemoryStorage()
    storage.content["mission.json"] = SAVED[:at] + damage + SAVED[at + len(damage) :]
    items, _ = load_items(storage, MissionType.MISSION)
    assert all(isinstance(item, MissionItem) for item in items)
