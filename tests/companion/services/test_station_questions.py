"""QGroundControl's connection: every question answered before the next tick, none left open."""

import dataclasses

import pytest
from boat_rig import BOAT, OK, UNSUPPORTED, Rig, Silent

from companion.core.units import deg_to_e7
from companion.mavlink.dialect import Message, dialect

pytestmark = pytest.mark.slow

STREAMS = {1: 2, 2: 2, 3: 2, 6: 3, 10: 10, 11: 10, 12: 3}
# What each of those groups must bring a boat
TELEMETRY = {
    "RAW_IMU": 2, "SCALED_IMU": 2,
    "SYS_STATUS": 2, "POWER_STATUS": 2, "GPS_RAW_INT": 2, "MISSION_CURRENT": 2, "NAV_CONTROLLER_OUTPUT": 2,
    "SERVO_OUTPUT_RAW": 2, "RC_CHANNELS": 2,
    "GLOBAL_POSITION_INT": 3, "LOCAL_POSITION_NED": 3,
    "ATTITUDE": 10, "VFR_HUD": 10,
    "SYSTEM_TIME": 3, "BATTERY_STATUS": 3, "EKF_STATUS_REPORT": 3,
    "HOME_POSITION": 1, "EXTENDED_SYS_STATE": 1,
}  # fmt: skip


@pytest.fixture
def rig() -> Rig:
    """A boat, and a station that has just said who it is."""
    rig = Rig().ready()
    rig.peer = rig.connect()
    rig.receive()
    rig.peer.heartbeat()
    rig.receive()
    return rig


def ask_rates(rig: Rig) -> None:
    """The streams five times, as QGroundControl does, and two messages by name."""
    for round_number in range(5):
        for group, rate_hz in STREAMS.items():
            rig.peer.send(dialect.MAVLink_request_data_stream_message(*BOAT, group, rate_hz, 1))
        if round_number == 0:
            for message_id in (242, 245):
                assert rig.ask(dialect.MAV_CMD_SET_MESSAGE_INTERVAL, message_id, 1e6) == OK
        rig.run(0.5)


def test_telemetry_comes_at_the_rates_asked_and_another_channel_keeps_its_own(rig: Rig) -> None:
    rig.peer.heartbeat()
    other = rig.connect()
    ask_rates(rig)
    rig.peer.forget()
    other.forget()
    rig.run(20.0)
    counts = {name: len(rig.peer.said(name)) / 20.0 for name in TELEMETRY}
    assert counts == pytest.approx(TELEMETRY, abs=1.01 / 20.0)
    assert len(other.said("ATTITUDE")) == pytest.approx(80, abs=1)
    assert not other.said("RAW_IMU")


def test_a_question_to_a_component_that_is_not_there_is_not_ours_to_answer(rig: Rig) -> None:
    for component in (100, 154, 190):
        rig.peer.forget()
        rig.peer.send(dialect.MAVLink_command_long_message(1, component, 521, 0, 1, 0, 0, 0, 0, 0, 0))
        rig.receive()
        assert not rig.peer.said("COMMAND_ACK")


def test_a_question_to_all_components_is_answered(rig: Rig) -> None:
    command = dialect.MAVLink_command_long_message(1, 0, 521, 0, 1, 0, 0, 0, 0, 0, 0)
    assert rig.answer_to(command, "COMMAND_ACK").result == UNSUPPORTED


def test_the_old_request_for_the_version_is_answered_with_the_version(rig: Rig) -> None:
    version = rig.answer_to(dialect.MAVLink_autopilot_version_request_message(*BOAT), "AUTOPILOT_VERSION")
    assert version.flight_sw_version == 0x04060000


def test_battery_and_home_come_often_enough_that_streams_are_asked_for_once(rig: Rig) -> None:
    """They are asked for again whenever one of the two has been missing for ten seconds."""
    ask_rates(rig)
    rig.peer.forget()
    last_s = {"BATTERY_STATUS": rig.now_s, "HOME_POSITION": rig.now_s}
    for _ in range(150):
        rig.step(5)
        for message in rig.peer.listen():
            if message.get_type() in last_s:
                last_s[message.get_type()] = rig.now_s
        assert all(rig.now_s - at_s < 5.0 for at_s in last_s.values())


def latest(rig: Rig, name: str) -> Message:
    return rig.peer.said(name)[-1]


def test_sticks_are_shown_as_they_are_obeyed_and_centred_when_let_go(rig: Rig) -> None:
    ask_rates(rig)
    rig.set_mode(0)
    rig.arm()
    for _ in range(50):
        rig.peer.heartbeat()
        rig.peer.send(dialect.MAVLink_manual_control_message(1, 0, -500, 400, 0, 0))
        rig.step(2)
    shown = latest(rig, "RC_CHANNELS")
    assert (shown.chan1_raw, shown.chan3_raw, shown.chancount) == (1250, 1700, 4)
    rig.run(3.0)
    shown = latest(rig, "RC_CHANNELS")
    assert (shown.chan1_raw, shown.chan3_raw) == (1500, 1500)


def test_the_estimates_flags_follow_its_health(rig: Rig) -> None:
    ask_rates(rig)
    report = latest(rig, "EKF_STATUS_REPORT")
    assert report.flags & dialect.EKF_POS_HORIZ_ABS
    assert report.flags & dialect.EKF_ATTITUDE
    assert not report.flags & dialect.EKF_UNINITIALIZED
    assert report.pos_horiz_variance < 0.5


def test_only_what_is_measured_is_in_the_imu(rig: Rig) -> None:
    ask_rates(rig)
    imu = latest(rig, "SCALED_IMU")
    assert (imu.xmag, imu.ymag, imu.zmag) == (0, 0, 0)  # the part gives a heading, not a field
    assert (imu.xacc, imu.yacc, imu.zacc, imu.xgyro, imu.ygyro) == (0, 0, 0, 0, 0)
    rig.ask(dialect.MAV_CMD_DO_MOTOR_TEST, 2, 0, 50.0, 2.0)
    rig.run(1.5)
    reading = rig.boat.sensors.compass
    assert reading is not None
    rate_rad_s = reading.yaw_rate_rad_s
    assert rate_rad_s is not None
    assert rate_rad_s > 0.1
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, dialect.MAVLINK_MSG_ID_RAW_IMU) == OK
    assert latest(rig, "RAW_IMU").zgyro == round(1e3 * rate_rad_s)


def test_the_origin_can_be_asked_for_and_fits_the_local_position(rig: Rig) -> None:
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, 49) == OK
    (origin,) = rig.peer.said("GPS_GLOBAL_ORIGIN")
    frame = rig.boat.estimator.frame
    assert frame is not None
    assert origin.latitude == deg_to_e7(frame.origin.lat_deg)


def test_the_set_of_the_water_and_the_estimates_accuracy_can_be_asked_for() -> None:
    rig = Rig("open", "environment.current_m_s=0.5", "environment.current_to_deg=90.0").ready()
    rig.run(20.0)
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, 250) == OK
    (drift,) = rig.peer.said("DEBUG_VECT")
    assert drift.name == "CURRENT"
    assert (drift.x, drift.y) == pytest.approx((0.0, 0.5), abs=0.1)
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, 230) == OK
    (status,) = rig.peer.said("ESTIMATOR_STATUS")
    assert status.flags & dialect.ESTIMATOR_POS_HORIZ_ABS
    assert 0.0 < status.pos_horiz_accuracy < 0.5


def test_dead_reckoning_is_told_as_what_it_is() -> None:
    rig = Rig("open").ready()
    rig.boat.sensors._hardware = dataclasses.replace(rig.hardware, gnss=Silent())
    rig.run(5.0)
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, 193) == OK
    (report,) = rig.peer.said("EKF_STATUS_REPORT")
    assert not report.flags & dialect.EKF_POS_HORIZ_ABS
    assert report.flags & dialect.EKF_POS_HORIZ_REL
    assert 0.8 <= report.pos_horiz_variance < 1.0
