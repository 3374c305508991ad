import logging
from collections.abc import Sequence

import pytest
from boat_rig import BOAT, HOME_ITEM, Rig, waypoint
from held_storage import HeldStorage
from hypothesis import given
from hypothesis import strategies as st
from mission_station import ACK, MISSION, OTHER, clear, count, result_of

from companion.core.storage import MemoryStorage, Saving, Storage
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionResult, MissionType
from companion.persistence.mission_store import encode_item, load_items, save_lines


def save_items(storage: Storage, kind: MissionType, items: Sequence[MissionItem]) -> Saving:
    return save_lines(storage, kind, [encode_item(item) for item in items])


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


def uploading(storage: HeldStorage) -> Rig:
    """A boat that holds MISSION and is writing OTHER."""
    save_items(storage, MissionType.MISSION, MISSION)
    storage.finish()
    rig = Rig(storage=storage)
    rig.step()
    assert rig.items() == tuple(MISSION)
    rig.peer.forget()
    rig.peer.send(count(3))
    for seq, item in enumerate(OTHER):
        rig.receive()
        rig.peer.send(item.to_message(seq, BOAT, MissionType.MISSION))
    rig.receive()
    return rig


def test_a_list_is_acknowledged_and_sailed_only_once_the_medium_has_it() -> None:
    storage = HeldStorage()
    rig = uploading(storage)
    rig.run(3.0)
    assert not rig.peer.said(ACK)
    assert rig.items() == tuple(MISSION)
    storage.finish()
    rig.step()
    assert [ack.type for ack in rig.peer.said(ACK)] == [dialect.MAV_MISSION_ACCEPTED]
    assert rig.items() == tuple(OTHER)
    assert rig.boat.vehicle.progress.last_seq == 2


def test_a_medium_that_refuses_is_reported_and_the_old_list_stays() -> None:
    storage = HeldStorage()
    rig = uploading(storage)
    storage.finish("No space left on device")
    rig.step()
    assert [ack.type for ack in rig.peer.said(ACK)] == [dialect.MAV_MISSION_ERROR]
    assert "Mission not stored: No space left on device" in rig.peer.texts
    assert rig.items() == tuple(MISSION)


@pytest.mark.parametrize("fault", ["", "read-only"])
def test_clearing_everything_waits_for_the_medium_too(fault: str) -> None:
    storage = HeldStorage()
    save_items(storage, MissionType.MISSION, MISSION)
    storage.finish()
    rig = Rig(storage=storage)
    rig.step()
    rig.peer.forget()
    rig.peer.send(clear(255))
    rig.run(1.0)
    assert not rig.peer.said(ACK)
    assert rig.items() == tuple(MISSION)
    assert result_of(rig, count(1)) is MissionResult.DENIED
    rig.peer.forget()
    storage.finish(fault)
    rig.step()
    expected = dialect.MAV_MISSION_ERROR if fault else dialect.MAV_MISSION_ACCEPTED
    assert [ack.type for ack in rig.peer.said(ACK)] == [expected]
    assert rig.items() == (tuple(MISSION) if fault else ())
