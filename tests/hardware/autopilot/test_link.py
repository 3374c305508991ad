"""Whom the boat listens to on an autopilot's line, and what it asks for."""

import math

import pytest
from autopilot_bench import Bench
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from twins.lines import known

GCS = 6


def heartbeat(system: int, component: int, kind: int = 11, autopilot: int = 3) -> bytes:
    wire = mavlink.MAVLink(None, srcSystem=system, srcComponent=component)
    return bytes(mavlink.MAVLink_heartbeat_message(kind, autopilot, 0x51, 0, 4, 3).pack(wire))


@pytest.mark.parametrize("other", [heartbeat(255, 190, GCS, 8), heartbeat(1, 154, 26, 8), heartbeat(9, 1)])
def test_only_the_autopilot_of_the_configuration_is_heard(other: bytes) -> None:
    bench = Bench(system_id=1)
    bench.feed(other)
    assert (bench.link.peer, bench.link.ignored) == (None, 1)
    bench.run(1.5)
    assert bench.link.peer == (1, 1)
    attitude = mavlink.MAVLink_attitude_message(1, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0)
    before = bench.readings.heading
    bench.feed(attitude.pack(mavlink.MAVLink(None, srcSystem=9, srcComponent=1)))
    assert bench.readings.heading is before


def test_streams_that_stop_are_asked_for_again() -> None:
    bench = Bench()
    bench.run(3.0)
    bench.rover.intervals_s.clear()
    bench.run(3.0)
    assert known(bench.readings.heading).time_s == pytest.approx(bench.now_s, abs=0.05)


def test_an_autopilot_that_falls_silent_is_told_once_and_so_is_its_return() -> None:
    bench = Bench()
    bench.run(3.0)
    bench.hears = False
    bench.run(3.0)
    bench.hears = True
    bench.run(3.0)
    assert bench.texts == ["Autopilot is silent", "Autopilot is heard again"]


def test_a_reboot_is_told_and_everything_is_asked_for_again() -> None:
    bench = Bench().ready()
    bench.texts.clear()
    bench.rover.reboot()
    bench.run(10.0)
    assert "Autopilot has rebooted" in bench.texts
    assert not bench.outputs.fault
    assert known(bench.readings.heading).time_s == pytest.approx(bench.now_s, abs=0.05)
    assert known(bench.readings.fix).reset_counter == 1


def test_warnings_of_the_autopilot_are_passed_on_and_reasons_for_not_arming_are_not() -> None:
    bench = Bench()
    bench.run(2.0)
    bench.rover.text(4, "EKF3 lane switch 1")
    bench.rover.text(6, "EKF3 active")
    bench.rover.text(2, "PreArm: Compass not healthy")
    bench.run(0.1)
    assert bench.texts == ["Autopilot: EKF3 lane switch 1"]


@given(st.binary(max_size=400), st.integers(0, 250))
def test_garbage_never_raises_and_the_line_recovers(noise: bytes, cut: int) -> None:
    bench = Bench()
    bench.run(1.5)
    bench.feed(bench.rover.step(0.2)[cut:])
    bench.feed(noise)
    bench.run(1.5)
    assert known(bench.readings.heading).time_s == pytest.approx(bench.now_s, abs=0.05)


@given(st.sampled_from(sorted(mavlink.mavlink_map)), st.binary(min_size=255, max_size=255))
def test_no_message_of_the_autopilot_raises_whatever_it_says(number: int, payload: bytes) -> None:
    kind = mavlink.mavlink_map[number]
    bench = Bench()
    bench.run(1.5)
    wire, size = mavlink.MAVLink(None, srcSystem=1, srcComponent=1), kind.unpacker.size
    blank = kind.__new__(kind)
    mavlink.MAVLink_message.__init__(blank, number, kind.msgname)
    bench.feed(bytes(blank._pack(wire, kind.crc_extra, payload[:size])))
    bench.run(0.5)
    heading = bench.readings.heading
    assert heading is None or math.isfinite(heading.heading_rad)
