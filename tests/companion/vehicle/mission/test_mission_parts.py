"""Parts of lists: MISSION_WRITE_PARTIAL_LIST and MISSION_REQUEST_PARTIAL_LIST."""

import pytest
from boat_rig import BOAT, Rig, waypoint
from hypothesis import given, settings
from hypothesis import strategies as st
from mission_station import ACK, MISSION, download, loaded, result_of

from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import MissionItem, MissionResult, MissionType

NEW = [waypoint(-10.0 * n, 5.0) for n in range(1, 6)]


def write(first: int, last: int, mission_type: int = 0) -> Message:
    message: Message = dialect.MAVLink_mission_write_partial_list_message(*BOAT, first, last, mission_type)
    return message


def send_part(
    rig: Rig, first: int, items: list[MissionItem], mission_type: MissionType = MissionType.MISSION
) -> int:
    """Offer a part and answer every request for it; the result of the ACK."""
    rig.peer.forget()
    rig.peer.send(write(first, first + len(items) - 1, mission_type))
    for _ in range(len(items) + 1):
        rig.receive()
        new = [one for one in rig.peer.listen() if one.get_type() in ("MISSION_REQUEST_INT", ACK)]
        for message in new:
            if message.get_type() == ACK:
                return int(message.type)
            rig.peer.send(items[message.seq - first].to_message(message.seq, BOAT, mission_type))
    raise AssertionError("no end")


@pytest.mark.parametrize(("first", "count"), [(1, 1), (1, 2), (3, 1), (2, 5), (4, 3), (0, 4)], ids=str)
def test_a_part_replaces_its_items_and_nothing_else(first: int, count: int) -> None:
    rig = loaded()
    part = NEW[:count]
    assert send_part(rig, first, part) == MissionResult.ACCEPTED
    expected = (*MISSION[:first], *part, *MISSION[first + count :])
    assert rig.items() == expected
    assert download(rig, rig.peer) == expected
    assert rig.boat.vehicle.progress.last_seq == len(expected) - 1
    rig.reboot()
    assert rig.items() == expected


@pytest.mark.parametrize(
    ("first", "last", "result"),
    [
        (5, 6, MissionResult.INVALID_SEQUENCE),
        (2, 1, MissionResult.INVALID_SEQUENCE),
        (-1, 1, MissionResult.INVALID_SEQUENCE),
        (1, 10, MissionResult.NO_SPACE),
    ],
)
def test_a_part_that_does_not_fit_is_refused_at_once(first: int, last: int, result: MissionResult) -> None:
    rig = loaded(Rig(config={"mission.max_items": 10}))
    assert result_of(rig, write(first, last)) is result
    assert rig.items() == tuple(MISSION)


def test_a_part_that_breaks_off_or_breaks_a_jump_leaves_the_old_list() -> None:
    rig = loaded()
    rig.answer_to(write(1, 2), "MISSION_REQUEST_INT")
    rig.peer.send(NEW[0].to_message(1, BOAT, MissionType.MISSION))
    rig.run(8.0)
    assert rig.items() == tuple(MISSION)
    jump = MissionItem(frame=2, command=177, param1=9.0, param2=1.0)
    assert send_part(rig, 2, [jump]) == MissionResult.INVALID_PARAM1
    assert rig.items() == tuple(MISSION)


def test_a_whole_list_offered_in_the_midst_of_a_part_begins_at_its_beginning() -> None:
    rig = loaded()
    rig.answer_to(write(2, 3), "MISSION_REQUEST_INT")
    count = dialect.MAVLink_mission_count_message(*BOAT, 2, 0)
    assert rig.answer_to(count, "MISSION_REQUEST_INT").seq == 0


@pytest.mark.parametrize(("first", "last", "seqs"), [(1, 2, [1, 2]), (0, -1, [0, 1, 2, 3]), (3, 3, [3])])
def test_a_part_that_is_asked_for_is_sent_as_it_is(first: int, last: int, seqs: list[int]) -> None:
    rig = loaded()
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_mission_request_partial_list_message(*BOAT, first, last, 0))
    rig.step(2)
    got = rig.peer.said("MISSION_ITEM_INT")
    assert [one.seq for one in got] == seqs
    assert [MissionItem.from_message(one) for one in got] == [MISSION[seq] for seq in seqs]


def test_a_long_part_goes_out_over_several_ticks_and_ends_with_the_list() -> None:
    rig = loaded(items=[*MISSION, *[waypoint(5.0 * n, 1.0) for n in range(96)]])
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_mission_request_partial_list_message(*BOAT, 0, -1, 0))
    rig.step()
    assert len(rig.peer.said("MISSION_ITEM_INT")) <= 10
    rig.step(15)
    assert [one.seq for one in rig.peer.said("MISSION_ITEM_INT")] == list(range(100))


@given(st.integers(-3, 8), st.integers(-3, 12), st.integers(0, 6))
@settings(max_examples=40)
def test_any_part_ends_with_the_old_list_or_the_spliced_one(first: int, last: int, given_items: int) -> None:
    rig = loaded()
    rig.peer.send(write(first, last))
    for offset in range(given_items):
        rig.receive()
        rig.peer.send(NEW[offset % 5].to_message(max(first, 0) + offset, BOAT, MissionType.MISSION))
    rig.receive()
    fits = 0 <= first <= min(last, len(MISSION)) and last - first + 1 <= given_items
    part = [NEW[n % 5] for n in range(last - first + 1)]
    expected = [*MISSION[:first], *part, *MISSION[last + 1 :]] if fits else MISSION
    assert rig.items() == tuple(expected)
    assert rig.boat.endpoint.faults == 0
