"""What the real ArduPilot Rover sent, from its start until it was armed and driven: tests/data/README.md."""

import math
import struct
from collections.abc import Iterator

import pytest
from autopilot_bench import config
from data_files import ROVER
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from twins.lines import known

from companion.hal.autopilot.link import AutopilotLink
from companion.hal.autopilot.mixing import pair_shares
from companion.mavlink.codec import Decoder

ARMED_S = 44.0  # as recorded


def frames() -> Iterator[tuple[float, bytes]]:
    """Seconds and frame, of a telemetry log."""
    data, at = ROVER.read_bytes(), 0
    while at < len(data):
        (micros,) = struct.unpack_from(">Q", data, at)
        size = 12 + data[at + 9] + (13 if data[at + 10] & 1 else 0)
        yield micros * 1e-6, data[at + 8 : at + 8 + size]
        at += 8 + size


def played(until_s: float) -> AutopilotLink:
    """The boat's end after so much of the recording; it was armed as when that was made."""
    link, decoder = AutopilotLink(config()), Decoder(datagram=True)
    for time_s, frame in frames():
        if time_s > until_s:
            break
        link.outputs.may_drive = ARMED_S < time_s < ARMED_S + 9.0
        for one in decoder.feed(frame):
            link.handle(one.message, one.sender, time_s)
        link.tick(time_s)
    return link


def read_by_pymavlink(name: str, until_s: float) -> mavlink.MAVLink_message:
    """The last of its name by then."""
    wire = mavlink.MAVLink(None)
    read = [
        message for time_s, one in frames() if time_s <= until_s for message in wire.parse_buffer(one) or []
    ]
    return [message for message in read if message.get_type() == name][-1]


def test_all_its_parameters_are_read_and_as_the_boat_needs_them() -> None:
    parameters = played(6.0).outputs.parameters
    assert parameters.is_complete
    assert (parameters.faults(), parameters.faults(is_needed=False)) == ([], [])


def test_its_readings_are_those_that_pymavlink_reads() -> None:
    readings = played(49.0).readings
    fix, attitude = read_by_pymavlink("GPS_RAW_INT", 49.0), read_by_pymavlink("ATTITUDE", 49.0)
    status = read_by_pymavlink("SYS_STATUS", 49.0)
    heading, battery, place = known(readings.heading), known(readings.battery), known(readings.fix)
    assert (heading.heading_rad, heading.yaw_rate_rad_s) == (attitude.yaw, attitude.yawspeed)
    assert (battery.voltage_v, known(battery.current_a)) == pytest.approx(
        (status.voltage_battery / 1e3, status.current_battery / 1e2)
    )
    assert math.hypot(known(place.north_m_s), known(place.east_m_s)) == pytest.approx(fix.vel / 100.0 + 0.005)
    assert (place.position.lat_deg, place.position.lon_deg) == pytest.approx((fix.lat / 1e7, fix.lon / 1e7))
    assert (place.fix_type, place.satellites, place.horizontal_accuracy_m) == (6, 10, 0.3)
    assert place.time_s == pytest.approx(49.0 - 0.11, abs=0.25)
    assert (readings.pings[-1].range_m, readings.dropped) == (None, 0)  # open water ahead


def test_it_has_no_heading_before_its_filter_has_one() -> None:
    assert played(6.0).readings.heading is None
    assert played(45.0).readings.heading is not None


def test_its_reason_for_not_arming_is_told() -> None:
    assert played(15.6).outputs.fault == "Gyros inconsistent"


def test_it_is_seen_to_be_ready_then_armed_and_then_disarmed() -> None:
    assert played(43.9).outputs.fault == ""
    beats = [read_by_pymavlink("HEARTBEAT", at_s).base_mode & 128 for at_s in (43.9, 47.0, 55.0)]
    assert beats == [0, 128, 0]


@pytest.mark.parametrize(("at_s", "left", "right"), [(48.5, 0.5, 0.3), (52.8, -0.5, -0.2)])
def test_its_motors_got_what_the_boat_demanded_also_astern(at_s: float, left: float, right: float) -> None:
    """Demands of the recorded session; SERVO1 and SERVO3 had 1000 to 2000 µs."""
    outputs = read_by_pymavlink("SERVO_OUTPUT_RAW", at_s)
    got = [(pulse_us - 1500.0) / 500.0 for pulse_us in (outputs.servo1_raw, outputs.servo3_raw)]
    assert got == pytest.approx([left, right], abs=0.01)
    link = played(at_s)
    (steering, throttle), (turn, ahead) = known(link.outputs._sticks), pair_shares(left, right)
    channels = read_by_pymavlink("RC_CHANNELS", at_s)
    assert (steering.pulse_us(turn), throttle.pulse_us(ahead)) == (channels.chan1_raw, channels.chan3_raw)
