"""The seeded channel does what its quality says, and the same again."""

import math
from dataclasses import astuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sitl.radio.channel import Channel, LinkSettings, Quality

qualities = st.builds(
    Quality,
    loss=st.floats(0.0, 1.0),
    delay_s=st.floats(0.0, 1.0),
    jitter_s=st.floats(0.0, 1.0),
    duplication=st.floats(0.0, 1.0),
)


def carry(
    channel: Channel, count: int, step_s: float = 0.01, until_s: float = 10.0
) -> list[tuple[float, bytes]]:
    for n in range(count):
        channel.send(n.to_bytes(2, "big"), n * step_s)
    ticks = int(until_s / step_s) + 1
    return [(k * step_s, data) for k in range(ticks) for data in channel.receive(k * step_s)]


def test_a_perfect_channel_hands_over_everything_at_once_and_in_order() -> None:
    channel = Channel(Quality(), seed=1)
    assert [data for _, data in carry(channel, 100)] == [n.to_bytes(2, "big") for n in range(100)]
    assert channel.is_empty


@given(qualities, st.integers(0, 2**32))
def test_the_same_seed_gives_the_same_fate(quality: Quality, seed: int) -> None:
    assert carry(Channel(quality, seed), 50, until_s=3.0) == carry(Channel(quality, seed), 50, until_s=3.0)


def test_loss_and_duplication_come_at_the_asked_rates() -> None:
    assert len(carry(Channel(Quality(loss=0.3), 3), 4000, step_s=0.001)) == pytest.approx(2800, rel=0.05)
    assert len(carry(Channel(Quality(duplication=0.3), 3), 4000, step_s=0.001)) == pytest.approx(
        5200, rel=0.05
    )


def test_nothing_arrives_before_its_delay_and_all_before_delay_and_jitter() -> None:
    channel = Channel(Quality(delay_s=0.2, jitter_s=0.1), seed=4)
    for k in range(200):
        channel.send(b"x", 5.0 + k * 1e-6)
    assert channel.receive(5.199) == []
    assert 0 < len(channel.receive(5.25)) < 200
    channel.receive(5.301)
    assert channel.is_empty


def test_bandwidth_spreads_a_burst_and_drops_what_would_wait_too_long() -> None:
    channel = Channel(Quality(bandwidth_bytes_s=1024.0, backlog_s=0.5), seed=6)
    for _ in range(100):
        channel.send(bytes(128), 0.0)  # 0.125 s each
    assert len(channel.receive(0.375)) == 3
    assert len(channel.receive(10.0)) == 2
    assert channel.is_empty


def test_two_channels_in_a_row_add_up() -> None:
    one = Quality(0.5, 0.1, 0.2, 0.5, 1000.0, reordering=0.5, reordering_s=0.1)
    other = Quality(0.2, 0.3, 0.1, 0.2, 500.0, reordering=0.2, reordering_s=0.3)
    assert astuple(one.with_(other)) == pytest.approx((0.6, 0.4, 0.3, 0.6, 500.0, 2.0, 0.6, 0.3))
    assert one.with_(Quality()).bandwidth_bytes_s == 1000.0
    assert LinkSettings().quality == Quality()


def test_what_is_held_back_comes_later_and_what_arrives_together_keeps_its_order() -> None:
    channel = Channel(Quality(reordering=1.0, reordering_s=0.5), seed=8)
    assert channel.next_s == math.inf
    for data in (b"b", b"a"):
        channel.send(data, 1.0)
    assert channel.next_s == 1.5
    assert channel.receive(1.4) == []
    assert channel.receive(1.5) == [b"b", b"a"]
