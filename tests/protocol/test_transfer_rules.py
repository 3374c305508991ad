"""The rules of the mission protocol one by one, as a station would see them."""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import ItemFault, MissionItem, MissionResult, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed, Failed, FailureCause, Started, Transfer, TransferState

BOAT, STATION, SECOND = Address(1, 1), Address(255, 190), Address(254, 190)
ITEMS = tuple(MissionItem(3, 16, x=n) for n in range(3))
MISSION, FENCE = MissionType.MISSION, MissionType.FENCE


def count(n: int, target: tuple[int, int] = BOAT, mission_type: int = MISSION) -> Message:
    message: Message = dialect.MAVLink_mission_count_message(*target, n, mission_type)
    return message


def item(seq: int, current: int = 0) -> Message:
    return MissionItem(3, 16, current=current, x=seq).to_message(seq, BOAT, MISSION)


def request(seq: int, old: bool = False) -> Message:
    kind = dialect.MAVLink_mission_request_message if old else dialect.MAVLink_mission_request_int_message
    message: Message = kind(*BOAT, seq)
    return message


def request_list() -> Message:
    message: Message = dialect.MAVLink_mission_request_list_message(*BOAT)
    return message


def ack(result: int = MissionResult.ACCEPTED) -> Message:
    message: Message = dialect.MAVLink_mission_ack_message(*BOAT, result)
    return message


def said(machine: Transfer) -> list[tuple[str, int]]:
    """What it sends, as (message, its number), each to the right partner with the right list."""
    short = []
    for message in machine.take_outbox():
        assert message.mission_type == machine.mission_type
        name = message.get_type().removeprefix("MISSION_")
        number = {"ACK": "type", "COUNT": "count", "REQUEST_LIST": "mission_type"}.get(name, "seq")
        short.append((name, int(getattr(message, number))))
    return short


def tell(
    machine: Sender | Receiver, *messages: Message, sender: Address = STATION, now_s: float = 0.0
) -> None:
    for message in messages:
        machine.handle(message, sender, now_s)


def receiving(n: int = 3, have: int = 0) -> Receiver:
    """A receiver in the middle of an upload, with nothing left to say."""
    machine = Receiver(BOAT, MISSION, retry_s=0.5, retries=3, max_items=5)
    tell(machine, count(n), *(item(k) for k in range(have)))
    machine.take_outbox()
    machine.take_events()
    return machine


def sending(items: Sequence[MissionItem] = ITEMS) -> Sender:
    """A sender that has offered its list by itself."""
    machine = Sender(BOAT, MISSION, retry_s=0.5, retries=3)
    machine.offer(items, STATION, 0.0)
    machine.take_outbox()
    machine.take_events()
    return machine


# --- receiver


def test_nothing_is_accepted_before_the_owner_has_stored_the_list() -> None:
    machine = receiving(3, have=3)
    for k in range(100):
        tell(machine, item(2), now_s=float(k))
        machine.tick(float(k))
    assert said(machine) == []
    machine.confirm(100.0, MissionResult.ERROR)
    assert said(machine) == [("ACK", MissionResult.ERROR)]


@pytest.mark.parametrize("target", [(1, 2), (2, 1), (2, 0), (0, 0), (0, 1)])
def test_a_count_that_does_not_name_us_is_not_ours(target: tuple[int, int]) -> None:
    machine = Receiver(BOAT, MISSION)
    tell(machine, count(3, target))
    assert (machine.state, said(machine), machine.take_events()) == (TransferState.IDLE, [], [])


def test_a_second_station_is_denied_and_the_first_goes_on() -> None:
    machine = receiving(3, have=1)
    machine.handle(count(2), SECOND, 0.0)
    (denial,) = machine.take_outbox()
    assert denial.type == MissionResult.DENIED
    assert Address(denial.target_system, denial.target_component) == SECOND
    machine.handle(item(1), SECOND, 0.0)
    machine.handle(ack(MissionResult.OPERATION_CANCELLED), SECOND, 0.0)
    assert machine.take_outbox() == []
    tell(machine, item(1), item(2))
    assert machine.take_events() == [Completed(ITEMS, STATION)]


def test_a_skipped_item_is_asked_for_again_but_not_in_a_storm() -> None:
    machine = receiving(5)
    for k in range(100):
        tell(machine, item(3), now_s=k * 0.001)
    assert said(machine) == [("REQUEST_INT", 0)]
    tell(machine, item(3), now_s=0.5)
    assert said(machine) == [("REQUEST_INT", 0)]


def test_more_items_than_there_is_room_for_are_refused_at_once() -> None:
    machine = Receiver(BOAT, MISSION, max_items=5)
    tell(machine, count(6))
    assert said(machine) == [("ACK", MissionResult.NO_SPACE)]
    (failed,) = machine.take_events()
    assert isinstance(failed, Failed)
    assert failed.text == "6 items offered, there is room for 5"
    assert machine.state is TransferState.IDLE


def test_a_station_s_cancel_ends_the_upload_at_once_and_is_not_answered() -> None:
    machine = receiving(3, have=1)
    tell(machine, ack(MissionResult.OPERATION_CANCELLED))
    (failed,) = machine.take_events()
    assert isinstance(failed, Failed)
    assert failed.result is MissionResult.OPERATION_CANCELLED
    assert (machine.partner, said(machine)) == (None, [])
    tell(machine, item(1))
    assert (said(machine), machine.take_events()) == ([], [])


def test_a_lost_item_is_asked_for_again_and_given_up_after_the_last_retry() -> None:
    machine = receiving(3, have=1)
    machine.tick(0.24)  # its first answer came at once
    assert said(machine) == []
    for n in range(3):
        machine.tick(0.25 * (n + 1))
        assert said(machine) == [("REQUEST_INT", 1)]
    machine.tick(1.0)
    assert said(machine) == [("ACK", MissionResult.OPERATION_CANCELLED)]
    (failed,) = machine.take_events()
    assert failed == Failed(
        MissionResult.OPERATION_CANCELLED, "no answer from 255/190 for 1.0 s", STATION, FailureCause.SILENT
    )


def test_an_item_that_the_owner_objects_to_ends_the_upload_with_its_reason() -> None:
    def check(seq: int, item: MissionItem) -> ItemFault | None:
        return (
            ItemFault(MissionResult.UNSUPPORTED, f"command {item.command} is unknown") if seq == 1 else None
        )

    machine = Receiver(BOAT, MISSION, check=check)
    tell(machine, count(3), item(0), item(1))
    assert said(machine)[-1] == ("ACK", MissionResult.UNSUPPORTED)
    assert machine.take_events()[-1] == Failed(
        MissionResult.UNSUPPORTED, "item 1: command 16 is unknown", STATION
    )
    tell(machine, item(1))
    assert said(machine) == [("ACK", MissionResult.UNSUPPORTED)]


@pytest.mark.parametrize("current", [2, 3])
def test_a_go_to_that_travels_as_an_item_belongs_to_no_list(current: int) -> None:
    machine = receiving(3)
    tell(machine, item(0, current=current))
    assert (said(machine), machine.take_events()) == ([], [])
    tell(machine, item(0, current=1))
    assert said(machine) == [("REQUEST_INT", 1)]


def test_a_lost_last_acknowledgement_is_given_again_for_a_while() -> None:
    machine = receiving(3, have=3)
    machine.confirm(10.0)
    machine.take_outbox()
    machine.take_events()
    tell(machine, item(2), now_s=10.5)
    tell(machine, item(2), now_s=11.0)
    assert said(machine) == [("ACK", MissionResult.ACCEPTED)] * 2
    assert machine.take_events() == []
    machine.tick(11.9)
    tell(machine, item(2), now_s=11.9)
    assert said(machine) == [("ACK", MissionResult.ACCEPTED)]
    machine.tick(12.0)
    tell(machine, item(2), now_s=12.5)
    assert said(machine) == [("ACK", MissionResult.ERROR)]


def finished(*, has_lost: bool = True) -> Receiver:
    """A receiver that has confirmed its list at 10 s, on a line that has lost something or nothing before."""
    machine = receiving(3, have=2)
    if has_lost:
        machine.tick(1.0)
    tell(machine, item(2), now_s=9.0)
    machine.take_outbox()
    machine.confirm(10.0)
    return machine


@pytest.mark.parametrize(("has_lost", "expected"), [(True, [0.0, 0.5, 1.0]), (False, [0.0])])
def test_where_something_was_lost_the_last_acknowledgement_is_said_twice_more(
    has_lost: bool, expected: list[float]
) -> None:
    machine = finished(has_lost=has_lost)
    told_s = []
    for tick in range(150):
        machine.tick(10.0 + 0.02 * tick)
        told_s += [round(0.02 * tick, 2)] * said(machine).count(("ACK", MissionResult.ACCEPTED))
    assert told_s == expected


@pytest.mark.parametrize("word", [count(2), ack(MissionResult.OPERATION_CANCELLED)])
def test_a_station_that_goes_on_has_heard_the_last_acknowledgement(word: Message) -> None:
    machine = finished()
    tell(machine, word, now_s=10.1)
    machine.take_outbox()
    machine.tick(10.55)
    assert ("ACK", MissionResult.ACCEPTED) not in said(machine)


# --- sender


def test_a_download_sends_the_list_of_the_moment_it_began() -> None:
    store = list(ITEMS)
    machine = Sender(BOAT, MISSION, source=lambda: store)
    tell(machine, request_list())
    assert said(machine) == [("COUNT", 3)]
    store.clear()
    tell(machine, request(0), request(1), request(2), ack())
    assert said(machine) == [("ITEM_INT", 0), ("ITEM_INT", 1), ("ITEM_INT", 2)]
    assert machine.take_events() == [Started(3, STATION), Completed(ITEMS, STATION)]


def test_a_second_station_is_denied_a_download_meanwhile() -> None:
    machine = Sender(BOAT, MISSION, source=lambda: ITEMS)
    tell(machine, request_list(), request(0))
    machine.take_outbox()
    for message in (request_list(), request(0)):
        machine.handle(message, SECOND, 0.0)
        (denial,) = machine.take_outbox()
        assert (denial.type, denial.target_system) == (MissionResult.DENIED, SECOND.system)
    machine.handle(ack(), SECOND, 0.0)
    tell(machine, request(1), request(2), ack())
    assert machine.take_events()[-1] == Completed(ITEMS, STATION)


def test_a_station_that_has_all_but_never_acknowledges_holds_nobody_up() -> None:
    machine = Sender(BOAT, MISSION, source=lambda: ITEMS)
    tell(machine, request_list(), request(0), request(1), request(2))
    machine.take_outbox()
    tell(machine, request_list(), sender=SECOND)
    (offer,) = machine.take_outbox()
    assert (offer.get_type(), offer.target_system) == ("MISSION_COUNT", SECOND.system)
    assert machine.partner == SECOND


def test_a_request_beyond_the_list_ends_it_as_out_of_sequence() -> None:
    machine = sending()
    tell(machine, request(3))
    assert said(machine) == [("ACK", MissionResult.INVALID_SEQUENCE)]
    (failed,) = machine.take_events()
    assert failed == Failed(MissionResult.INVALID_SEQUENCE, "item 3 was asked for, the list has 3", STATION)


def test_an_acknowledgement_before_all_was_asked_for_is_not_believed() -> None:
    machine = sending()
    tell(machine, ack(), request(0), request(1), ack())
    assert machine.take_events() == []
    tell(machine, request(2), ack())
    assert machine.take_events() == [Completed(ITEMS, STATION)]


def test_asking_for_the_same_item_for_ever_is_no_progress() -> None:
    machine = sending()
    now_s = 0.0
    while machine.state is not TransferState.SETTLED:
        now_s += 0.05
        tell(machine, request(0), now_s=now_s)
        machine.tick(now_s)
        assert now_s < 2.5


def test_requests_after_the_end_are_answered_but_do_not_keep_it_alive() -> None:
    machine = sending()
    tell(machine, request(0), ack(MissionResult.OPERATION_CANCELLED))
    machine.take_outbox()
    tell(machine, request(1), request(2), now_s=1.9)
    assert said(machine) == [("ITEM_INT", 1), ("ITEM_INT", 2)]
    machine.tick(2.0)
    assert machine.is_idle


@pytest.mark.parametrize("machine", [receiving(3, have=1), sending()], ids=["receiver", "sender"])
def test_our_own_cancel_is_told_to_the_partner(machine: Transfer) -> None:
    machine.cancel(0.0)
    assert said(machine) == [("ACK", MissionResult.OPERATION_CANCELLED)]
    (failed,) = machine.take_events()
    assert isinstance(failed, Failed)
    machine.cancel(0.0)
    assert said(machine) == []


# --- both

wire_messages = st.one_of(
    st.builds(count, st.integers(0, 8), st.sampled_from([BOAT, (1, 0), (1, 9), (0, 0)]), st.integers(0, 3)),
    st.builds(item, st.integers(0, 8), st.integers(0, 3)),
    st.builds(request, st.integers(0, 8), st.booleans()),
    st.builds(request_list),
    st.builds(ack, st.integers(0, 255)),
)


@given(
    st.lists(
        st.tuples(
            wire_messages, st.sampled_from([STATION, SECOND, BOAT, Address(0, 0)]), st.floats(0.0, 1.0)
        ),
        max_size=60,
    )
)
def test_no_order_of_messages_raises_or_makes_a_machine_answer_more_than_once_a_message(
    script: list[tuple[Message, Address, float]],
) -> None:
    receiver = Receiver(BOAT, MISSION, max_items=5)
    sender = Sender(BOAT, MISSION, source=lambda: ITEMS)
    now_s = 0.0
    for message, address, pause_s in script:
        now_s += pause_s
        for machine in (receiver, sender):
            machine.handle(message, address, now_s)
            assert len(machine.take_outbox()) <= 1
            machine.tick(now_s)
            assert len(machine.take_outbox()) <= 1
        for event in receiver.take_events():
            if isinstance(event, Completed):
                assert [i.x for i in event.items] == list(range(len(event.items)))
                receiver.confirm(now_s)
                assert len(receiver.take_outbox()) == 1


def test_a_count_of_none_and_a_clear_are_an_empty_list() -> None:
    clear: Message = dialect.MAVLink_mission_clear_all_message(*BOAT, MISSION)
    for message in (count(0), clear):
        machine = Receiver(BOAT, MISSION)
        tell(machine, message)
        assert machine.take_events() == [Started(0, STATION), Completed((), STATION)]
        machine.confirm(0.0)
        assert said(machine) == [("ACK", MissionResult.ACCEPTED)]


def test_a_doubled_part_only_repeats_the_first_request_and_another_part_begins_again() -> None:
    machine = Receiver(BOAT, MISSION)
    machine.take_part(1, 2, STATION, 0.0)
    assert said(machine) == [("REQUEST_INT", 1)]
    machine.take_part(1, 2, STATION, 0.1)
    assert said(machine) == [("REQUEST_INT", 1)]
    assert machine.take_events() == [Started(2, STATION)]
    machine.take_part(1, 2, SECOND, 0.1)
    assert (said(machine), machine.partner) == ([("ACK", MissionResult.DENIED)], STATION)
    machine.take_part(4, 2, STATION, 0.2)
    assert (said(machine), machine.take_events()) == ([("REQUEST_INT", 4)], [Started(2, STATION)])
    tell(machine, item(4), item(5))
    assert machine.take_events() == [
        Completed((MissionItem(3, 16, x=4), MissionItem(3, 16, x=5)), STATION, 4)
    ]


def test_a_station_that_never_answers_an_offer_is_told_of_with_the_time_since_it() -> None:
    machine = Sender(BOAT, MISSION, retry_s=0.5, retries=3)
    machine.offer(ITEMS, STATION, 5.0)
    for tick in range(1, 5):
        machine.tick(5.0 + 0.5 * tick)
    failed = machine.take_events()[-1]
    assert isinstance(failed, Failed)
    assert failed.text == "no answer from 255/190 for 2.0 s"
