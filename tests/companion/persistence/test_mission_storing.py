"""Lists on the medium: what a slow, full or dying one does to an upload, and clearing."""

import pytest
from boat_rig import BOAT, Rig
from held_storage import HeldStorage
from mission_station import ACK, FENCE, MISSION, OTHER, RALLY, clear, count, result_of

from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionResult, MissionType
from companion.mavlink.transfer import Completed
from companion.persistence.mission_store import save_items


@pytest.mark.parametrize("kind", list(MissionType))
def test_one_list_is_cleared_and_the_others_stay(kind: MissionType) -> None:
    rig = Rig()
    rig.step()
    lists = {MissionType.MISSION: MISSION, MissionType.FENCE: FENCE, MissionType.RALLY: RALLY}
    for one, items in lists.items():
        assert isinstance(rig.upload(items, mission_type=one), Completed)
    assert result_of(rig, clear(kind)) is MissionResult.ACCEPTED
    rig.reboot()
    for one, items in lists.items():
        assert rig.items(one) == (() if one is kind else tuple(items))


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
