"""Every row of the transition table is walked through the machines' own verbs, and no other row exists."""

from collections.abc import Callable

import pytest

from companion.core.errors import LocalProtocolError
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import MissionItem, MissionResult, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Transfer
from companion.mavlink.transfer_table import TRANSITIONS, TransferState, TransferTrigger

BOAT, STATION = Address(1, 1), Address(255, 190)
ITEMS = (MissionItem(3, 16, x=1), MissionItem(3, 16, x=2))
RETRY_S, RETRIES = 0.5, 2
FOREVER_S = 1000.0


def count(n: int) -> Message:
    message: Message = dialect.MAVLink_mission_count_message(*BOAT, n)
    return message


def item(seq: int, frame: int = 3) -> Message:
    return MissionItem(frame, 16, x=seq).to_message(seq, BOAT, MissionType.MISSION)


def request(seq: int) -> Message:
    message: Message = dialect.MAVLink_mission_request_int_message(*BOAT, seq)
    return message


def ack(result: MissionResult) -> Message:
    message: Message = dialect.MAVLink_mission_ack_message(*BOAT, result)
    return message


def tell(machine: Sender | Receiver, *messages: Message) -> None:
    for message in messages:
        machine.handle(message, STATION, 0.0)


def wait(machine: Transfer) -> None:
    """Let all retries pass."""
    for n in range(RETRIES + 1):
        machine.tick((n + 1) * RETRY_S)


def receiver_in(state: TransferState) -> Receiver:
    machine = Receiver(BOAT, MissionType.MISSION, RETRY_S, RETRIES, max_items=10)
    if state is TransferState.LISTING:
        machine.request_list(STATION, 0.0)
    elif state is not TransferState.IDLE:
        tell(machine, count(2))
    if state in (TransferState.STORING, TransferState.SETTLED):
        tell(machine, item(0), item(1))
    if state is TransferState.SETTLED:
        machine.confirm(0.0)
    assert machine.state is state
    return machine


def sender_in(state: TransferState) -> Sender:
    machine = Sender(BOAT, MissionType.MISSION, RETRY_S, RETRIES)
    if state is not TransferState.IDLE:
        machine.offer(ITEMS, STATION, 0.0)
    if state in (TransferState.SENDING, TransferState.SETTLED):
        tell(machine, request(0), request(1))
    if state is TransferState.SETTLED:
        tell(machine, ack(MissionResult.ACCEPTED))
    assert machine.state is state
    return machine


def accept_an_empty_offer(machine: Sender) -> None:
    machine.offer((), STATION, 0.0)
    tell(machine, ack(MissionResult.ACCEPTED))


RECEIVER_WAYS: dict[TransferTrigger, Callable[[Receiver], None]] = {
    TransferTrigger.ASK: lambda m: m.request_list(STATION, 0.0),
    TransferTrigger.COUNT: lambda m: tell(m, count(3)),
    TransferTrigger.EMPTY: lambda m: tell(m, count(0)),
    TransferTrigger.ITEM: lambda m: tell(m, item(0)),
    TransferTrigger.LAST_ITEM: lambda m: tell(m, item(0), item(1)),
    TransferTrigger.STORED: lambda m: m.confirm(0.0),
    TransferTrigger.REFUSED: lambda m: tell(m, ack(MissionResult.OPERATION_CANCELLED)),
    TransferTrigger.FAULT: lambda m: m.cancel(0.0),
    TransferTrigger.EXPIRED: wait,
}
SENDER_WAYS: dict[TransferTrigger, Callable[[Sender], None]] = {
    TransferTrigger.OFFER: lambda m: m.offer(ITEMS, STATION, 0.0),
    TransferTrigger.REQUEST: lambda m: tell(m, request(0)),
    TransferTrigger.ACCEPTED: lambda m: tell(m, ack(MissionResult.ACCEPTED)),
    TransferTrigger.REFUSED: lambda m: tell(m, ack(MissionResult.NO_SPACE)),
    TransferTrigger.FAULT: lambda m: tell(m, request(7)),
    TransferTrigger.EXPIRED: wait,
}
RECEIVER_STATES = (
    TransferState.IDLE,
    TransferState.LISTING,
    TransferState.RECEIVING,
    TransferState.STORING,
    TransferState.SETTLED,
)
SENDER_STATES = (TransferState.IDLE, TransferState.OFFERING, TransferState.SENDING, TransferState.SETTLED)

ROWS = [(state, trigger) for state, row in TRANSITIONS.items() for trigger in row]
RECEIVER_ROWS = [(s, t) for s, t in ROWS if s in RECEIVER_STATES and t in RECEIVER_WAYS]
SENDER_ROWS = [(s, t) for s, t in ROWS if s in SENDER_STATES and t in SENDER_WAYS]


def row_id(value: object) -> str:
    return value.name if isinstance(value, TransferState | TransferTrigger) else str(value)


@pytest.mark.parametrize(("state", "trigger"), RECEIVER_ROWS, ids=row_id)
def test_a_receiver_follows_the_row(state: TransferState, trigger: TransferTrigger) -> None:
    machine = receiver_in(state)
    RECEIVER_WAYS[trigger](machine)
    assert machine.state is TRANSITIONS[state][trigger]


@pytest.mark.parametrize(("state", "trigger"), SENDER_ROWS, ids=row_id)
def test_a_sender_follows_the_row(state: TransferState, trigger: TransferTrigger) -> None:
    machine = sender_in(state)
    if (state, trigger) == (TransferState.OFFERING, TransferTrigger.ACCEPTED):
        accept_an_empty_offer(machine)
    else:
        SENDER_WAYS[trigger](machine)
    assert machine.state is TRANSITIONS[state][trigger]


def test_every_row_belongs_to_a_machine_and_is_walked() -> None:
    assert set(RECEIVER_ROWS) | set(SENDER_ROWS) == set(ROWS)
    assert set(TRANSITIONS) == set(TransferState)
    assert {trigger for _, trigger in ROWS} == set(TransferTrigger)


@pytest.mark.parametrize("state", RECEIVER_STATES, ids=row_id)
@pytest.mark.parametrize("trigger", RECEIVER_WAYS, ids=row_id)
def test_a_receiver_without_a_row_stays_where_it_is(state: TransferState, trigger: TransferTrigger) -> None:
    if trigger in TRANSITIONS[state] or trigger is TransferTrigger.LAST_ITEM:
        return  # a last item is an item to every state but RECEIVING
    machine = receiver_in(state)
    if trigger in (TransferTrigger.ASK, TransferTrigger.STORED):
        with pytest.raises(LocalProtocolError, match=f"{trigger.name} .* {state.name}"):
            RECEIVER_WAYS[trigger](machine)
    else:
        RECEIVER_WAYS[trigger](machine)
    assert machine.state is state


@pytest.mark.parametrize("state", SENDER_STATES, ids=row_id)
@pytest.mark.parametrize("trigger", SENDER_WAYS, ids=row_id)
def test_a_sender_without_a_row_stays_where_it_is(state: TransferState, trigger: TransferTrigger) -> None:
    if trigger in TRANSITIONS[state]:
        return
    machine = sender_in(state)
    SENDER_WAYS[trigger](machine)
    assert machine.state is state


@pytest.mark.parametrize("state", [TransferState.LISTING, TransferState.RECEIVING], ids=row_id)
def test_a_receiver_with_nobody_answering_comes_to_rest(state: TransferState) -> None:
    machine = receiver_in(state)
    now_s = 0.0
    while machine.state is not TransferState.IDLE:
        now_s += 0.1
        machine.tick(now_s)
        assert now_s < FOREVER_S
    assert now_s == pytest.approx(2 * RETRY_S * (RETRIES + 1), abs=0.5)
