"""The mission protocol as stations see it: real frames over memory links, a whole boat behind them."""

import pytest
from boat_rig import BOAT, HOME_ITEM, QGC, Rig, waypoint
from hypothesis import given, settings
from hypothesis import strategies as st
from mission_station import ACK, FENCE, MISSION, OTHER, RALLY, clear, count, download, loaded, result_of

from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionResult, MissionType
from companion.mavlink.transfer import Completed, Failed


@pytest.mark.parametrize("is_datagram", [True, False], ids=["datagrams", "stream"])
@pytest.mark.parametrize(
    ("mission_type", "items"),
    [(MissionType.MISSION, MISSION), (MissionType.FENCE, FENCE), (MissionType.RALLY, RALLY)],
)
def test_what_was_uploaded_reads_back_equal_and_survives_a_restart(
    mission_type: MissionType, items: list[MissionItem], is_datagram: bool
) -> None:
    rig = Rig()
    peer = rig.connect(QGC, is_datagram)
    rig.step()
    assert isinstance(rig.upload(items, peer, mission_type), Completed)
    assert download(rig, peer, mission_type) == tuple(items)
    rig.reboot()
    rig.step()
    assert download(rig, rig.peer, mission_type) == tuple(items)


def test_a_station_on_another_channel_is_denied_even_with_the_same_ids() -> None:
    rig = loaded()
    second = rig.connect(QGC)
    rig.receive()
    request = rig.answer_to(count(3), "MISSION_REQUEST_INT")
    assert request.seq == 0
    assert result_of(rig, count(2), second) is MissionResult.DENIED
    assert result_of(rig, clear(0), second) is MissionResult.DENIED
    assert result_of(rig, clear(255), second) is MissionResult.DENIED
    second.forget()
    second.send(OTHER[1].to_message(0, BOAT, MissionType.MISSION))  # an item of its own gets nowhere
    rig.receive()
    assert not second.said("MISSION_REQUEST_INT")
    for seq, item in enumerate(OTHER):
        rig.peer.send(item.to_message(seq, BOAT, MissionType.MISSION))
        rig.receive()
    assert rig.items() == tuple(OTHER)


def test_an_upload_that_breaks_off_times_out_with_the_old_mission_whole() -> None:
    rig = loaded()
    rig.answer_to(count(3), "MISSION_REQUEST_INT")
    rig.peer.send(OTHER[0].to_message(0, BOAT, MissionType.MISSION))
    rig.run(8.0)
    assert rig.items() == tuple(MISSION)
    assert [ack.type for ack in rig.peer.said(ACK)] == [dialect.MAV_MISSION_OPERATION_CANCELLED]
    assert len([one for one in rig.peer.said("MISSION_REQUEST_INT") if one.seq == 1]) >= 5
    assert any("Mission upload failed" in text for text in rig.peer.texts)


def bad(command: int = 16, **fields: float) -> MissionItem:
    return MissionItem(frame=3, command=command, **{"x": 500_000_000, "y": -12_000_000, **fields})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("item", "result", "words"),
    [
        (bad(command=84), MissionResult.UNSUPPORTED, "command 84"),
        (bad(command=177, param1=9.0, param2=1.0), MissionResult.INVALID_PARAM1, "jumps to 9"),
    ],
)
def test_a_bad_item_is_refused_by_number_and_field_while_the_boat_sails_on(
    item: MissionItem, result: MissionResult, words: str
) -> None:
    rig = Rig().sail(*MISSION[1:])
    rig.run(3.0)
    rig.peer.forget()
    outcome = rig.upload([HOME_ITEM, waypoint(5.0, 5.0), item])
    assert isinstance(outcome, Failed)
    assert outcome.result is result
    (text,) = [text for text in rig.peer.texts if words in text]
    assert "item 2" in text
    assert rig.items() == tuple(MISSION)
    assert (rig.mode, rig.boat.vehicle.progress.current_seq) == ("AUTO", 1)
    assert rig.world.truth.surge_m_s > 1.0


@pytest.mark.parametrize(("system", "component"), [(2, 1), (1, 190), (0, 0), (0, 1)])
def test_a_list_for_somebody_else_or_for_everybody_is_ignored(system: int, component: int) -> None:
    rig = loaded()
    rig.peer.forget()
    rig.peer.send(count(2, 0, system, component))
    for kind in (0, 255):
        rig.peer.send(dialect.MAVLink_mission_clear_all_message(system, component, kind))
    rig.peer.send(dialect.MAVLink_mission_set_current_message(system, component, 3))
    rig.receive()
    assert not rig.peer.listen()
    assert rig.items() == tuple(MISSION)
    assert rig.boat.vehicle.progress.current_seq == 1


def test_an_upload_in_auto_swaps_whole_and_the_boat_sails_the_new_list() -> None:
    rig = Rig().sail(*MISSION[1:])
    rig.run(5.0)
    rig.answer_to(count(3), "MISSION_REQUEST_INT")
    for seq, item in enumerate(OTHER[:2]):
        rig.peer.send(item.to_message(seq, BOAT, MissionType.MISSION))
        rig.step()
        assert rig.boat.vehicle.progress.last_seq == 3, (
            "nothing of the new list is sailed before all is there"
        )
    rig.peer.send(OTHER[2].to_message(2, BOAT, MissionType.MISSION))
    rig.step()
    assert rig.boat.vehicle.progress.last_seq == 2
    assert rig.mode == "AUTO"
    left_m = rig.offset_m(-30.0, 0.0)
    rig.until(lambda: rig.offset_m(-30.0, 0.0) < left_m - 3.0, 20.0)


ANY_ITEM = st.builds(
    MissionItem,
    frame=st.sampled_from([0, 1, 3, 6]),
    command=st.sampled_from([16, 17, 19, 20, 93, 177, 178, 201]),
    param1=st.floats(width=32),
    param2=st.floats(width=32),
    x=st.integers(-(2**31), 2**31 - 1),
    y=st.integers(-(2**31), 2**31 - 1),
)


@settings(max_examples=15)  # each with a boat of its own
@given(st.lists(ANY_ITEM, min_size=1, max_size=4))
def test_any_upload_ends_with_the_new_list_or_the_old_one_whole(items: list[MissionItem]) -> None:
    rig = loaded()
    outcome = rig.upload(items)
    assert rig.items() == (tuple(items) if isinstance(outcome, Completed) else tuple(MISSION))
    rig.run(0.2)
    assert rig.boat.endpoint.faults == 0
