"""Clocks: what is answered, what is estimated, what date is believed."""

import pytest
from boat_rig import QGC, Rig, Silent
from hypothesis import given
from hypothesis import strategies as st

from companion.mavlink.address import Address
from companion.mavlink.dialect import dialect
from companion.services.outbox import Origin, Outbox
from companion.services.time_sync import ASK_S, TimeService

NOON_2026 = 1_780_000_000.0
PEER = Address(1, 191)


def asked(service: TimeService, outbox: Outbox, now_s: float) -> int:
    """The stamp of the question that goes out at a time."""
    service.tick(now_s)
    (question,) = [out.message for out in outbox.drain()]
    assert question.tc1 == 0
    return int(question.ts1)


def test_a_question_about_the_time_is_answered_at_once_with_its_own_stamp() -> None:
    rig = Rig()
    rig.run(2.0)
    answer = rig.answer_to(dialect.MAVLink_timesync_message(0, 123_456_789), "TIMESYNC")
    assert answer.ts1 == 123_456_789
    assert answer.tc1 == pytest.approx(2.0e9, abs=0.1e9)


def test_a_ping_to_everybody_is_answered_and_an_answer_is_not() -> None:
    rig = Rig()
    rig.step()
    answer = rig.answer_to(dialect.MAVLink_ping_message(55, 7, 0, 0), "PING")
    assert (answer.time_usec, answer.seq) == (55, 7)
    assert (answer.target_system, answer.target_component) == tuple(rig.peer.address)
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_ping_message(55, 7, 1, 1))
    rig.peer.send(dialect.MAVLink_ping_message(55, 7, 1, 0))
    rig.receive()
    assert not rig.peer.said("PING")


@given(st.floats(-1e6, 1e6), st.floats(0.0, 0.9), st.floats(0.0, 0.9))
def test_the_offset_is_off_by_no_more_than_half_the_difference_of_the_ways(
    offset_s: float, there_s: float, back_s: float
) -> None:
    outbox = Outbox()
    service = TimeService(outbox)
    stamp = asked(service, outbox, ASK_S)
    theirs_ns = round((ASK_S + there_s + offset_s) * 1e9) or 1
    answer = dialect.MAVLink_timesync_message(theirs_ns, stamp)
    service.on_timesync(answer, Origin(1, PEER), ASK_S + there_s + back_s)
    assert service.clocks[PEER].offset_s == pytest.approx(offset_s, abs=0.5 * abs(there_s - back_s) + 1e-6)


def test_the_shortest_way_is_believed_until_it_is_old() -> None:
    outbox = Outbox()
    service = TimeService(outbox)
    for number, way_s in enumerate((0.1, 0.02, 0.3)):
        now_s = ASK_S * (number + 1)
        stamp = asked(service, outbox, now_s)
        answer = dialect.MAVLink_timesync_message(round((now_s + 100.0) * 1e9), stamp)
        service.on_timesync(answer, Origin(1, PEER), now_s + way_s)
    assert service.clocks[PEER].way_s == pytest.approx(0.02)
    stamp = asked(service, outbox, 200.0)
    service.on_timesync(dialect.MAVLink_timesync_message(round(300e9), stamp), Origin(1, PEER), 200.3)
    assert service.clocks[PEER].way_s == pytest.approx(0.3)


def test_an_answer_to_a_question_never_asked_and_a_late_one_are_left_out() -> None:
    outbox = Outbox()
    service = TimeService(outbox)
    stamp = asked(service, outbox, ASK_S)
    service.on_timesync(dialect.MAVLink_timesync_message(5, stamp + 1), Origin(1, PEER), ASK_S)
    service.on_timesync(dialect.MAVLink_timesync_message(5, stamp), Origin(1, PEER), ASK_S + 3.0)
    assert not service.clocks


def test_a_crowd_of_clocks_is_forgotten_oldest_first() -> None:
    outbox = Outbox()
    service = TimeService(outbox)
    for number in range(60):
        now_s = ASK_S * (number + 1)
        stamp = asked(service, outbox, now_s)
        answer = dialect.MAVLink_timesync_message(1, stamp)
        service.on_timesync(answer, Origin(1, Address(number + 1, 1)), now_s + 0.01)
    assert len(service.clocks) == 16
    assert Address(60, 1) in service.clocks
    assert Address(1, 1) not in service.clocks


def test_a_stamp_is_read_by_its_senders_clock_where_that_is_known() -> None:
    outbox = Outbox()
    service = TimeService(outbox)
    assert service.to_own_clock(PEER, 0, 50.0) == 50.0
    stamp = asked(service, outbox, ASK_S)
    service.on_timesync(
        dialect.MAVLink_timesync_message(round((ASK_S + 500.0) * 1e9), stamp), Origin(1, PEER), ASK_S
    )
    assert service.to_own_clock(PEER, 549_900_000, 50.0) == pytest.approx(49.9)
    assert service.to_own_clock(PEER, 551_000_000, 50.0) == 50.0
    assert service.to_own_clock(PEER, 540_000_000, 50.0) == 50.0


def date(rig: Rig) -> float:
    """SYSTEM_TIME's date in s, without the seconds since boot."""
    rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, dialect.MAVLINK_MSG_ID_SYSTEM_TIME)
    message = rig.peer.said("SYSTEM_TIME")[-1]
    return float(message.time_unix_usec * 1e-6 - message.time_boot_ms * 1e-3)


def tell_date(rig: Rig, unix_s: float, address: Address = QGC, mav_type: int = dialect.MAV_TYPE_GCS) -> None:
    peer = rig.peer if address == rig.peer.address else rig.connect(address)
    rig.step()
    peer.heartbeat(mav_type)
    peer.send(dialect.MAVLink_system_time_message(round(unix_s * 1e6), 0))
    rig.step(2)


def test_a_station_sets_the_date_of_a_boat_that_has_none() -> None:
    rig = Rig(gnss=Silent())
    rig.step(2)
    assert rig.peer.said("SYSTEM_TIME")[-1].time_unix_usec == 0
    tell_date(rig, NOON_2026)
    assert date(rig) == pytest.approx(NOON_2026, abs=1.0)
