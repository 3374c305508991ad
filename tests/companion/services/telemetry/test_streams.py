import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.mavlink.dialect import dialect
from companion.services.telemetry.streams import GROUPS, Streams

ATTITUDE = dialect.MAVLINK_MSG_ID_ATTITUDE
SYS_STATUS = dialect.MAVLINK_MSG_ID_SYS_STATUS
TICK_S = 0.02


def sent(streams: Streams, seconds: float, message_id: int = ATTITUDE, first_tick: int = 0) -> int:
    """How often a message is due within some seconds of ticks."""
    ticks = range(first_tick, first_tick + round(seconds / TICK_S))
    return sum(streams.due(tick * TICK_S).count(message_id) for tick in ticks)


@given(st.floats(0.02, 5.0))
def test_a_message_comes_as_often_as_asked(interval_s: float) -> None:
    streams = Streams(0.0)
    streams.set_interval(ATTITUDE, interval_s, 0.0)
    assert sent(streams, 60.0) == pytest.approx(60.0 / interval_s, abs=1.01)


def test_a_long_pause_piles_up_no_work() -> None:
    streams = Streams(0.0)
    streams.set_interval(ATTITUDE, 0.1, 0.0)
    streams.due(0.0)
    assert streams.due(100.0) == [ATTITUDE]
    assert streams.due(100.02) == []


def test_unasked_streams_follow_the_configured_rate_and_none_flow_at_zero() -> None:
    assert sent(Streams(4.0), 10.0) == 40
    assert sent(Streams(4.0), 10.0, SYS_STATUS) == 10
    assert sent(Streams(0.0), 10.0) == 0


def test_group_zero_is_all_groups_and_an_unknown_group_is_none() -> None:
    streams = Streams(0.0)
    streams.set_group(77, 5.0, 0.0)
    assert streams.due(0.0) == []
    streams.set_group(dialect.MAV_DATA_STREAM_ALL, 5.0, 0.0)
    assert set(streams.due(0.0)) == {one for group in GROUPS.values() for one in group}
