"""Bytes of scanning lidars: packets of an LD06, requests and answers of an RPLIDAR A1."""

import math
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.lidars import LD06_MANUAL, LD20_IN_THE_OPEN, NODES_HZ, RAYS_HZ, Ld06Twin, RplidarTwin

from companion.sensors.framing import FrameReader
from companion.sensors.lidar import ld06, rplidar
from companion.sensors.lidar.ld06 import Ld06Reader
from companion.sensors.lidar.rplidar import RplidarReader
from companion.sensors.lidar.sectors import NO_ECHO, Ray

SCANS = bytes.fromhex("A55A0500004081")  # the answer to SCAN in Slamtec's protocol description
# Others' worked examples: 45.5°, 1234.75 mm, quality 10; 180°, 1 m, quality 63; 90° without a range
NODE, NODE_180, NODE_BLANK = (bytes.fromhex(text) for text in ("29C1164B13", "FD015AA00F", "82012D0000"))


def degrees(rays: list[Ray]) -> list[float]:
    return [math.degrees(angle_rad) for angle_rad, _ in rays]


def test_the_packet_of_the_manual_has_its_rays() -> None:
    rays = ld06.rays_of(Ld06Reader().split(LD06_MANUAL))
    assert [range_m for _, range_m in rays] == [
        0.224, 0.220, 0.217, 0.213, 0.211, 0.208, 0.205, 0.202, 0.199, 0.197, 0.194, 0.192
    ]  # fmt: skip
    assert degrees(rays)[::11] == pytest.approx([324.27, 334.70])
    assert degrees(rays)[1] == pytest.approx(324.27 + 10.43 / 11.0)


def test_a_packet_from_the_open_has_no_echo_though_its_rays_have_a_confidence() -> None:
    rays = ld06.rays_of(Ld06Reader().split(LD20_IN_THE_OPEN))
    assert [range_m for _, range_m in rays] == [NO_ECHO] * 12


def test_angles_go_on_through_the_zero() -> None:
    twin = Ld06Twin(lambda angle_deg: (1000 + round(10.0 * angle_deg), 200))
    (*_, packet) = Ld06Reader().split(twin.say(38 * 12 / 4500.0))
    angles = degrees(ld06.rays_of([packet]))
    assert angles[0] < 360.0 < angles[-1]
    for angle_deg, (_, range_m) in zip(angles, ld06.rays_of([packet]), strict=True):
        assert range_m == pytest.approx(1.0 + 0.01 * (angle_deg % 360.0), abs=1e-3)


@pytest.mark.parametrize(("confidence", "is_told"), [(20, True), (19, False)])
def test_a_weak_echo_is_neither_one_nor_none(confidence: int, is_told: bool) -> None:
    (packet,) = Ld06Reader().split(Ld06Twin(lambda _: (2000, confidence)).say(12 / 4500.0))
    assert all((range_m == 2.0) if is_told else math.isnan(range_m) for _, range_m in ld06.rays_of([packet]))


@given(at=st.integers(0, 46), bit=st.integers(0, 7))
def test_a_packet_with_a_wrong_bit_is_dropped_and_counted_and_the_next_one_found(at: int, bit: int) -> None:
    reader, broken = Ld06Reader(), bytearray(LD06_MANUAL)
    broken[at] ^= 1 << bit
    assert reader.split(bytes(broken) + LD20_IN_THE_OPEN) == [LD20_IN_THE_OPEN]
    assert reader.skipped == 47


def test_answers_and_measurements_of_the_description_are_told_apart() -> None:
    reader = RplidarReader()
    frames = reader.split(
        bytes.fromhex("A55A0300000006 023412") + SCANS + NODE + NODE_180 + NODE_BLANK + 4 * NODE
    )
    assert [rplidar.health_of(frame) for frame in frames] == [(rplidar.ERROR, 0x1234)] + [None] * 5
    rays = rplidar.rays_of(frames)
    assert degrees(rays) == pytest.approx([45.5, 180.0, 90.0, 45.5])
    assert [range_m for _, range_m in rays] == [1.23475, 1.0, NO_ECHO, 1.23475]
    assert reader.skipped == 0


def test_a_range_without_quality_is_doubtful() -> None:
    node = bytes([NODE[0] & 3, *NODE[1:]])
    ((_, range_m),) = rplidar.rays_of([node])
    assert math.isnan(range_m)


def test_an_a2s_motor_is_told_its_speed_with_a_checksum() -> None:
    twin = RplidarTwin()
    twin.hear(rplidar.SPIN)  # asserts it
    assert twin.requests == b"\xf0"


def test_rays_follow_each_other_as_the_parts_measure() -> None:
    assert rplidar.RAY_S == 1.0 / NODES_HZ
    assert ld06.RAY_S == 1.0 / RAYS_HZ


def scan_of(twin: RplidarTwin, seconds: float) -> bytes:
    return twin.hear(rplidar.SCAN) + twin.say(seconds)


@given(cut=st.integers(20, 900), length=st.integers(1, 60))
def test_a_scan_that_lost_bytes_gets_into_step_again_at_once(cut: int, length: int) -> None:
    stream = scan_of(RplidarTwin(lambda angle_deg: (1500 + round(4.0 * angle_deg), 15)), 0.5)
    reader = RplidarReader()
    rays = rplidar.rays_of(reader.split(stream[:cut] + stream[cut + length :]))
    right = [ray for ray in rays if ray[1] == pytest.approx(1.5 + 0.004 * math.degrees(ray[0]), abs=1e-3)]
    assert len(rays) - len(right) <= 1  # the one that the gap joined
    assert len(right) > 1000 - length / 5.0 - 10.0


READERS: list[Callable[[], FrameReader]] = [Ld06Reader, RplidarReader]


@pytest.mark.parametrize("reader_of", READERS)
@given(noise=st.lists(st.binary(max_size=80) | st.just(SCANS) | st.just(b"\xa5\x5a") | st.just(b"\x54\x2c")))
def test_garbage_is_never_raised_and_not_kept(
    reader_of: Callable[[], FrameReader], noise: list[bytes]
) -> None:
    reader = reader_of()
    for chunk in noise:
        frames = reader.split(chunk)
        rplidar.rays_of(frames)
        for frame in frames:
            rplidar.health_of(frame)
        assert len(reader._held) < 64


@pytest.mark.parametrize(
    ("reader_of", "said"), [(Ld06Reader, Ld06Twin().say(0.1)), (RplidarReader, scan_of(RplidarTwin(), 0.1))]
)
@given(data=st.data())
def test_frames_are_found_after_garbage_in_any_pieces(
    reader_of: Callable[[], FrameReader], said: bytes, data: st.DataObject
) -> None:
    noise = data.draw(st.binary(max_size=60).map(lambda one: one.replace(b"\x54", b"").replace(b"\xa5", b"")))
    reader, stream, frames = reader_of(), noise + said, list[bytes]()
    while stream:
        size = data.draw(st.integers(1, 300))
        frames += reader.split(stream[:size])
        stream = stream[size:]
    assert frames == reader_of().split(said)
    assert reader.skipped == len(noise)
