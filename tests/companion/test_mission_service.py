"""The mission protocol as stations see it: real frames over memory links, a whole boat behind them."""

import math

import pytest
from boat_rig import BOAT, HOME_ITEM, OK, PLANNER, QGC, Peer, Rig, waypoint
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import MissionItem, MissionResult, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.transfer import Completed, Failed
from companion.services.mission_store import save_items
from companion.storage import MemoryStorage, Saving

MISSION = [HOME_ITEM, waypoint(40.0, 0.0), waypoint(40.0, 40.0), waypoint(0.0, 40.0)]
OTHER = [HOME_ITEM, waypoint(-30.0, 0.0), waypoint(-30.0, -30.0)]
FENCE = [MissionItem(frame=0, command=5001, param1=3.0, x=500_000_000 + n, y=-12_000_000) for n in range(3)]
RALLY = [MissionItem(frame=3, command=5100, x=500_001_000, y=-12_001_000)]
ACK = "MISSION_ACK"


def download(
    rig: Rig, peer: Peer, mission_type: MissionType = MissionType.MISSION
) -> tuple[MissionItem, ...]:
    """Read a list back as a station does."""
    receiver = Receiver(peer.address, MissionType(mission_type))
    receiver.request_list(BOAT, rig.now_s)
    for _ in range(2000):
        for message in receiver.take_outbox():
            peer.send(message)
        rig.receive()
        for message in peer.listen():
            if message.get_type().startswith("MISSION_"):
                receiver.handle(message, BOAT, rig.now_s)
        for event in receiver.take_events():
            if isinstance(event, Completed):
                receiver.confirm(rig.now_s)
                for message in receiver.take_outbox():
                    peer.send(message)
                rig.receive()
                return event.items
            assert not isinstance(event, Failed)
    raise AssertionError("the download never ended")


def count(items: int, mission_type: int = 0, system: int = 1, component: int = 1) -> Message:
    message: Message = dialect.MAVLink_mission_count_message(system, component, items, mission_type)
    return message


def clear(mission_type: int, system: int = 1) -> Message:
    message: Message = dialect.MAVLink_mission_clear_all_message(system, 1, mission_type)
    return message


def result_of(rig: Rig, message: Message, peer: Peer | None = None) -> MissionResult:
    return MissionResult(rig.answer_to(message, ACK, peer).type)


def loaded(rig: Rig | None = None, items: list[MissionItem] | None = None) -> Rig:
    rig = rig or Rig()
    rig.step()
    assert isinstance(rig.upload(items or MISSION), Completed)
    return rig


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


def test_a_hundred_items_are_uploaded_between_two_ticks() -> None:
    rig = Rig()
    rig.step()
    items = [HOME_ITEM, *[waypoint(5.0 * n, 0.0) for n in range(1, 100)]]
    before_s = rig.now_s
    assert isinstance(rig.upload(items), Completed)
    assert rig.now_s == before_s
    assert rig.items() == tuple(items)


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


def test_two_stations_may_read_at_the_same_time() -> None:
    rig = loaded()
    second = rig.connect(QGC)
    rig.receive()
    assert rig.answer_to(dialect.MAVLink_mission_request_list_message(*BOAT, 0), "MISSION_COUNT").count == 4
    assert download(rig, second) == tuple(MISSION)
    asked = dialect.MAVLink_mission_request_message(*BOAT, 1, 0)  # the old form is answered with ITEM_INT
    assert MissionItem.from_message(rig.answer_to(asked, "MISSION_ITEM_INT")) == MISSION[1]


def test_a_cancel_leaves_the_old_mission_and_frees_the_boat() -> None:
    rig = loaded()
    rig.answer_to(count(3), "MISSION_REQUEST_INT")
    rig.peer.send(dialect.MAVLink_mission_ack_message(*BOAT, dialect.MAV_MISSION_OPERATION_CANCELLED, 0))
    rig.receive()
    assert rig.items() == tuple(MISSION)
    second = rig.connect(PLANNER)
    rig.receive()
    assert isinstance(rig.upload(OTHER, second), Completed)


def test_an_upload_that_breaks_off_times_out_with_the_old_mission_whole() -> None:
    rig = loaded()
    rig.answer_to(count(3), "MISSION_REQUEST_INT")
    rig.peer.send(OTHER[0].to_message(0, BOAT, MissionType.MISSION))
    rig.run(8.0)
    assert rig.items() == tuple(MISSION)
    assert [ack.type for ack in rig.peer.said(ACK)] == [dialect.MAV_MISSION_OPERATION_CANCELLED]
    assert len([one for one in rig.peer.said("MISSION_REQUEST_INT") if one.seq == 1]) >= 5
    assert any("Mission upload failed" in text for text in rig.peer.texts)


def test_an_upload_whose_link_closes_holds_up_nobody() -> None:
    rig = loaded()
    rig.answer_to(count(3), "MISSION_REQUEST_INT")
    rig.peer.link.close()
    rig.receive()
    second = rig.connect(QGC)
    rig.receive()
    assert isinstance(rig.upload(OTHER, second), Completed)


def bad(command: int = 16, **fields: float) -> MissionItem:
    return MissionItem(frame=3, command=command, **{"x": 500_000_000, "y": -12_000_000, **fields})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("item", "result", "words"),
    [
        (bad(x=0, y=0), MissionResult.INVALID_PARAM5_X, "position 0, 0"),
        (bad(command=84), MissionResult.UNSUPPORTED, "command 84"),
        (bad(command=177, param1=9.0, param2=1.0), MissionResult.INVALID_PARAM1, "jumps to 9"),
        (bad(command=93, param1=-1.0), MissionResult.INVALID_PARAM1, "delay -1"),
        (bad(x=2**31 - 1), MissionResult.INVALID_PARAM5_X, "latitude"),
    ],
)
def test_a_bad_item_is_refused_by_number_and_field_while_the_boat_sails_on(
    item: MissionItem, result: MissionResult, words: str
) -> None:
    rig = Rig().sail(*MISSION[1:])
    rig.run(5.0)
    rig.peer.forget()
    outcome = rig.upload([HOME_ITEM, waypoint(5.0, 5.0), item])
    assert isinstance(outcome, Failed)
    assert outcome.result is result
    (text,) = [text for text in rig.peer.texts if words in text]
    assert "item 2" in text
    assert rig.items() == tuple(MISSION)
    speed_before = rig.world.truth.surge_m_s
    rig.run(5.0)
    assert (rig.mode, rig.boat.vehicle.progress.current_seq) == ("AUTO", 1)
    assert speed_before > 1.0
    assert rig.world.truth.surge_m_s > 1.0


def test_an_old_item_whose_latitude_is_nan_is_refused_and_the_boat_lives() -> None:
    rig = loaded()
    rig.answer_to(count(2), "MISSION_REQUEST_INT")
    old = dialect.MAVLink_mission_item_message(*BOAT, 0, 3, 16, 0, 1, 0, 0, 0, 0, math.nan, -1.2, 0.0, 0)
    assert result_of(rig, old) is MissionResult.INVALID_PARAM5_X
    assert any("item 0" in text for text in rig.peer.texts)
    assert rig.items() == tuple(MISSION)
    assert rig.boat.endpoint.faults == 0


def test_too_many_items_are_refused_before_the_first_is_asked_for() -> None:
    rig = loaded(Rig(config={"mission.max_items": 10}))
    assert result_of(rig, count(11)) is MissionResult.NO_SPACE
    assert rig.items() == tuple(MISSION)


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


def test_a_list_of_a_kind_that_does_not_exist_is_refused_at_once() -> None:
    rig = loaded()
    answer = rig.answer_to(count(2, 7), ACK)
    assert (answer.type, answer.mission_type) == (dialect.MAV_MISSION_UNSUPPORTED, 7)


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


def test_a_count_of_nothing_clears_too() -> None:
    rig = loaded()
    assert result_of(rig, count(0)) is MissionResult.ACCEPTED
    assert rig.items() == ()
    assert rig.boat.vehicle.progress.is_empty


def test_all_lists_are_cleared_in_one() -> None:
    rig = loaded()
    assert isinstance(rig.upload(FENCE, mission_type=MissionType.FENCE), Completed)
    assert result_of(rig, clear(255)) is MissionResult.ACCEPTED
    rig.reboot()
    assert [rig.items(kind) for kind in MissionType] == [(), (), ()]


def test_fence_and_rally_are_kept_and_the_operator_is_told_that_they_do_nothing_yet() -> None:
    rig = Rig()
    rig.step()
    assert isinstance(rig.upload(FENCE, mission_type=MissionType.FENCE), Completed)
    rig.step()
    assert "Fence stored, but this boat does not act on it yet" in rig.peer.texts
    outcome = rig.upload(
        [MissionItem(frame=3, command=5100, x=2_000_000_000)], mission_type=MissionType.RALLY
    )
    assert isinstance(outcome, Failed)


def test_an_upload_in_auto_swaps_whole_and_the_boat_sails_the_new_list() -> None:
    rig = Rig().sail(*MISSION[1:])
    rig.run(10.0)
    north_m = rig.world.truth.north_m
    assert north_m > 5.0
    rig.answer_to(count(3), "MISSION_REQUEST_INT")
    for seq, item in enumerate(OTHER[:2]):
        rig.peer.send(item.to_message(seq, BOAT, MissionType.MISSION))
        rig.step()
        assert (
            rig.boat.vehicle.progress.last_seq == 3
        )  # nothing of the new list is sailed before all of it is there
    rig.peer.send(OTHER[2].to_message(2, BOAT, MissionType.MISSION))
    rig.step()
    assert rig.boat.vehicle.progress.last_seq == 2
    assert rig.mode == "AUTO"
    rig.until(lambda: rig.offset_m(-30.0, 0.0) < 3.0, 60.0)


class SlowStorage(MemoryStorage):
    """A medium that takes its time: nothing is kept before `finish`, and then perhaps not."""

    def __init__(self) -> None:
        super().__init__()
        self.waiting: list[tuple[str, bytes, SlowSaving]] = []

    def save(self, name: str, content: bytes) -> Saving:
        saving = SlowSaving()
        self.waiting.append((name, content, saving))
        return saving

    def finish(self, fault: str = "") -> None:
        for name, content, saving in self.waiting:
            if not fault:
                self.content[name] = content
            saving.done, saving.fault = True, fault
        self.waiting.clear()


class SlowSaving:
    """One of its writes."""

    def __init__(self) -> None:
        self.done = False
        self.fault = ""

    def is_done(self) -> bool:
        return self.done

    def error(self) -> str:
        return self.fault


def uploading(storage: SlowStorage) -> Rig:
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
    storage = SlowStorage()
    rig = uploading(storage)
    rig.run(3.0)
    assert not rig.peer.said(ACK)
    assert rig.items() == tuple(MISSION)
    storage.finish()
    rig.step()
    assert [ack.type for ack in rig.peer.said(ACK)] == [dialect.MAV_MISSION_ACCEPTED]
    assert rig.items() == tuple(OTHER)
    assert rig.boat.vehicle.progress.last_seq == 2


def test_a_power_cut_while_a_list_is_written_leaves_the_old_one() -> None:
    rig = uploading(SlowStorage())
    rig.reboot()
    assert rig.items() == tuple(MISSION)
    assert rig.boat.vehicle.progress.last_seq == 3


def test_a_medium_that_refuses_is_reported_and_the_old_list_stays() -> None:
    storage = SlowStorage()
    rig = uploading(storage)
    storage.finish("No space left on device")
    rig.step()
    assert [ack.type for ack in rig.peer.said(ACK)] == [dialect.MAV_MISSION_ERROR]
    assert "Mission not stored: No space left on device" in rig.peer.texts
    assert rig.items() == tuple(MISSION)


@pytest.mark.parametrize("fault", ["", "read-only"])
def test_clearing_everything_waits_for_the_medium_too(fault: str) -> None:
    storage = SlowStorage()
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


@pytest.mark.parametrize("form", ["MISSION_ITEM", "MISSION_ITEM_INT"])
def test_the_old_go_to_sails_there_and_touches_no_list(form: str) -> None:
    rig = loaded(Rig().ready())
    there = waypoint(20.0, 0.0)
    assert rig.set_mode(15) == OK
    args = (*BOAT, 0, 3, 16, 2, 1, 0.0, 0.0, 0.0, math.nan)
    if form == "MISSION_ITEM":
        message = dialect.MAVLink_mission_item_message(*args, there.x / 1e7, there.y / 1e7, 50.0, 0)
    else:
        message = dialect.MAVLink_mission_item_int_message(*args, there.x, there.y, 50.0, 0)
    assert result_of(rig, message) is MissionResult.ACCEPTED
    target = rig.boat.vehicle.target
    assert target is not None
    assert target.lat_deg == pytest.approx(
        there.x / 1e7, abs=4e-6
    )  # a float32 degree is some decimetres wide
    assert rig.items() == tuple(MISSION)


@pytest.mark.parametrize(
    ("lat", "mode", "result"),
    [(50.0, 4, MissionResult.ERROR), (math.nan, 15, MissionResult.INVALID_PARAM5_X)],
)
def test_an_old_go_to_that_cannot_be_sailed_is_refused(lat: float, mode: int, result: MissionResult) -> None:
    rig = Rig().ready()
    rig.set_mode(mode)
    item = dialect.MAVLink_mission_item_message(*BOAT, 0, 3, 16, 2, 1, 0, 0, 0, 0, lat, -1.2, 0.0, 0)
    assert result_of(rig, item) is result
    assert rig.boat.vehicle.target is None


def test_the_current_item_is_set_and_told_at_once() -> None:
    rig = loaded()
    current = rig.answer_to(dialect.MAVLink_mission_set_current_message(*BOAT, 2), "MISSION_CURRENT")
    assert (current.seq, current.total) == (2, 3)
    current = rig.answer_to(dialect.MAVLink_mission_set_current_message(*BOAT, 9), "MISSION_CURRENT")
    assert current.seq == 2
    assert "Mission has no item 9 (last is 3)" in rig.peer.texts


def test_each_item_is_reported_once_and_in_order_with_the_current_item_moving_along() -> None:
    items = [waypoint(10.0, 0.0), waypoint(10.0, 10.0), waypoint(0.0, 10.0)]
    rig = Rig().sail(*items)
    rig.peer.forget()
    rig.until(lambda: rig.mode != "AUTO", 90.0)
    rig.run(0.5)
    assert [message.seq for message in rig.peer.said("MISSION_ITEM_REACHED")] == [1, 2, 3]
    seen = [message.seq for message in rig.peer.said("MISSION_CURRENT")]
    assert sorted(seen) == seen
    assert set(seen) == {1, 2, 3}


ANY_ITEM = st.builds(
    MissionItem,
    frame=st.sampled_from([0, 1, 3, 6]),
    command=st.sampled_from([16, 17, 19, 20, 93, 177, 178, 201]),
    param1=st.floats(width=32),
    param2=st.floats(width=32),
    x=st.integers(-(2**31), 2**31 - 1),
    y=st.integers(-(2**31), 2**31 - 1),
)


@given(st.lists(ANY_ITEM, min_size=1, max_size=4))
@settings(max_examples=60)
def test_any_upload_ends_with_the_new_list_or_the_old_one_whole(items: list[MissionItem]) -> None:
    rig = loaded()
    outcome = rig.upload(items)
    assert rig.items() == (tuple(items) if isinstance(outcome, Completed) else tuple(MISSION))
    rig.run(0.2)
    assert rig.boat.endpoint.faults == 0
