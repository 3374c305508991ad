"""A boat with a transmitter, in lockstep: sticks by schedule, faults, and what stations see of it."""

import math

import pytest
from boat_rig import OK, UNSUPPORTED, Rig, waypoint

from companion.core.units import wrap_pi
from companion.mavlink.dialect import dialect

ARM_UP, ARM_DOWN = 2000, 1000
MANUAL, HOLD, LOITER, AUTO = 1100, 1300, 1425, 1550
REST = 1500
REJECTED_FOR_NOW = dialect.MAV_RESULT_TEMPORARILY_REJECTED
RC_BIT = dialect.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
RC_SIGNAL, OFF = dialect.FAILURE_UNIT_SYSTEM_RC_SIGNAL, dialect.FAILURE_TYPE_OFF
KEYS = "vehicle.rc={arm_channel=5, mode_channel=6}"


def step(
    at_s: float, throttle: int = REST, steering: int = REST, arm: int = ARM_UP, mode: int = MANUAL
) -> str:
    return f"{{at_s={at_s}, channels=[{steering}, 1500, {throttle}, 1500, {arm}, {mode}, 1500, 1500]}}"


def sticks(*steps: str) -> str:
    return f"sensors.rc={{fitted=true, sticks=[{', '.join(steps)}]}}"


def speed_m_s(rig: Rig) -> float:
    truth = rig.world.truth
    return math.hypot(truth.north_m_s, truth.east_m_s)


def under_way(*settings: str) -> Rig:
    """Armed by the switch, full ahead in MANUAL since 4 s."""
    rig = Rig("open", KEYS, sticks(step(0.0, arm=ARM_DOWN), step(3.0), step(4.0, throttle=2000)), *settings)
    rig.run(8.0)
    assert rig.boat.vehicle.armed
    assert rig.mode == "MANUAL"
    assert speed_m_s(rig) > 1.0
    return rig


def test_a_hand_on_shore_arms_sails_out_turns_and_disarms_without_any_station() -> None:
    rig = Rig(
        "open",
        KEYS,
        sticks(
            step(0.0, arm=ARM_DOWN),
            step(3.0),
            step(4.0, throttle=2000),
            step(14.0, throttle=1800, steering=1900),
            step(18.0, throttle=1800),
            step(24.0),
            step(26.0, arm=ARM_DOWN),
        ),
    )
    rig.run(13.9)
    assert rig.offset_m(rig.scenario.start.north_m, rig.scenario.start.east_m) > 10.0
    ahead_rad = rig.world.truth.heading_rad
    rig.run(2.0)
    assert wrap_pi(rig.world.truth.heading_rad - ahead_rad) > 0.3  # to starboard
    rig.run(11.0)
    assert not rig.boat.vehicle.armed
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)
    assert rig.peer.texts[-1] == "Disarmed by the arming switch"


def test_the_helm_follows_the_stick_within_three_ticks() -> None:
    rig = under_way()
    radio = rig.world.electronics.rc
    assert radio is not None
    rig.run(1.0)
    radio.hold((1500, 1500, 1000, 1500, ARM_UP, MANUAL))
    rig.step(3)
    assert rig.boat.command.left < 1.0


@pytest.mark.parametrize("kind", ["off", "failsafe", "garbage"])
def test_a_boat_by_hand_keeps_station_where_it_lost_its_transmitter(kind: str) -> None:
    rig = under_way(f'faults=[{{what="rc", kind="{kind}", at_s=10.0}}]')
    rig.run(2.0)
    assert rig.until(lambda: rig.mode == "LOITER", 4.0) < 2.7
    assert any(text.startswith("Failsafe: RC lost:") for text in rig.peer.texts)
    rig.run(15.0)
    truth = rig.world.truth
    rig.run(60.0)
    assert rig.offset_m(truth.north_m, truth.east_m) < 3.0


def test_sticks_that_freeze_look_like_sticks_that_are_held_and_a_station_stops_the_boat() -> None:
    rig = under_way('faults=[{what="rc", kind="stuck", at_s=9.0}]')
    rig.run(10.0)
    assert rig.mode == "MANUAL"
    assert speed_m_s(rig) > 1.0
    assert rig.set_mode(4) == OK
    rig.run(5.0)
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)


def test_a_mission_without_its_transmitter_keeps_station_goes_home_and_can_be_taken_up_again() -> None:
    rig = Rig(
        "open", KEYS, "vehicle.failsafe={long_timeout_s=30.0}",
        sticks(step(0.0, arm=ARM_DOWN)), 'faults=[{what="rc", at_s=20.0, for_s=15.0}]',
    ).ready()  # fmt: skip
    rig.upload([waypoint(0.0, 0.0), waypoint(200.0, 0.0)])
    radio = rig.world.electronics.rc
    assert radio is not None
    radio.hold((1500, 1500, 1500, 1500, ARM_UP, AUTO))
    rig.run(1.0)
    assert (rig.mode, rig.boat.vehicle.armed) == ("AUTO", True)
    rig.until(lambda: rig.mode == "LOITER", 25.0)
    assert rig.now_s == pytest.approx(22.0, abs=0.2)
    rig.run(16.0)
    assert "Failsafe over: transmitter heard again" in rig.peer.texts
    assert rig.mode == "LOITER"
    radio.hold((1500, 1500, 1500, 1500, ARM_UP, MANUAL))
    rig.run(0.5)
    radio.hold((1500, 1500, 1500, 1500, ARM_UP, AUTO))
    rig.run(20.0)
    assert rig.mode == "AUTO"
    assert rig.world.truth.north_m > rig.scenario.start.north_m + 20.0


def test_stations_see_channels_signal_and_health() -> None:
    rig = under_way("sensors.rc.quality=0.5", "sensors.rc.noise_us=0.0")
    rig.peer.forget()
    rig.run(3.0)
    channels = rig.peer.said("RC_CHANNELS")[-1]
    assert channels.chancount == 8
    assert (channels.chan1_raw, channels.chan3_raw, channels.chan5_raw) == (1500, 2000, ARM_UP)
    assert channels.chan9_raw == 0xFFFF
    assert channels.rssi == 127
    rig.boat.parameters.set("FS_THR_ENABLE", 0.0)
    rig.peer.forget()
    rig.run(3.0)
    assert not rig.peer.said("SYS_STATUS")[-1].onboard_control_sensors_enabled & RC_BIT
    rig.boat.parameters.set("FS_THR_ENABLE", 1.0)
    rig.peer.forget()
    rig.run(3.0)
    status = rig.peer.said("SYS_STATUS")[-1]
    assert status.onboard_control_sensors_present & RC_BIT
    assert status.onboard_control_sensors_enabled & RC_BIT
    assert status.onboard_control_sensors_health & RC_BIT


def test_a_boat_that_sails_out_of_range_comes_back_into_it_by_its_failsafe() -> None:
    rig = under_way("sensors.rc.range_m=60.0", "vehicle.failsafe={long_timeout_s=20.0}")
    radio = rig.world.electronics.rc
    assert radio is not None
    rig.until(lambda: rig.mode == "LOITER", 60.0)
    lost_m = rig.offset_m(rig.scenario.start.north_m, rig.scenario.start.east_m)
    assert 55.0 < lost_m < 70.0
    rig.until(lambda: rig.mode == "RTL", 25.0)
    rig.until(lambda: "Failsafe over: transmitter heard again" in rig.peer.texts, 60.0)
    assert rig.offset_m(rig.scenario.start.north_m, rig.scenario.start.east_m) < lost_m
    assert rig.mode == "RTL"


def test_the_signal_grows_weaker_with_the_distance() -> None:
    rig = under_way("sensors.rc.range_m=60.0")
    radio = rig.world.electronics.rc
    assert radio is not None
    signals = []
    for _ in range(3):
        reading = radio.read()
        assert reading is not None
        assert reading.quality is not None
        assert reading.rssi_dbm is not None
        signals.append((reading.quality, reading.rssi_dbm))
        rig.run(7.0)
    assert signals == sorted(signals, reverse=True)
    assert signals[0][0] == 1.0
    assert 0.0 < signals[-1][0] < 1.0


def test_stations_see_a_lost_transmitter() -> None:
    rig = under_way('faults=[{what="rc", at_s=9.0}]')
    rig.run(2.0)
    rig.peer.forget()
    rig.run(3.0)
    channels = rig.peer.said("RC_CHANNELS")[-1]
    assert (channels.chancount, channels.rssi, channels.chan1_raw) == (0, 0, 0xFFFF)
    status = rig.peer.said("SYS_STATUS")[-1]
    assert status.onboard_control_sensors_present & RC_BIT
    assert not status.onboard_control_sensors_health & RC_BIT


def test_an_override_stands_in_the_channels_that_stations_see_and_ends_with_its_time() -> None:
    rig = under_way("sensors.rc.noise_us=0.0")
    for _ in range(20):
        rig.peer.heartbeat()
        rig.peer.send(dialect.MAVLink_rc_channels_override_message(1, 1, 0, 0, 1250, 0, 0, 0, 0, 0))
        rig.run(0.2)
    assert rig.boat.command.left < 0.0
    channels = rig.peer.said("RC_CHANNELS")[-1]
    assert (channels.chan1_raw, channels.chan3_raw, channels.chan5_raw) == (1500, 1250, ARM_UP)
    rig.run(2.0)
    assert rig.boat.command.left == pytest.approx(1.0)
    assert "Helm: the transmitter's again" in rig.peer.texts


def test_a_boat_without_a_receiver_says_nothing_of_one() -> None:
    rig = Rig().ready()
    rig.run(3.0)
    assert not rig.peer.said("SYS_STATUS")[-1].onboard_control_sensors_present & RC_BIT
    assert rig.peer.said("RC_CHANNELS")[-1].chancount == 4


def test_the_receiver_fails_by_command_and_by_parameter() -> None:
    rig = under_way()
    assert rig.ask(dialect.MAV_CMD_INJECT_FAILURE, RC_SIGNAL, OFF) == OK
    rig.until(lambda: rig.mode == "LOITER", 3.0)
    assert rig.ask(dialect.MAV_CMD_INJECT_FAILURE, RC_SIGNAL, 0) == OK
    rig.until(lambda: "Failsafe over: transmitter heard again" in rig.peer.texts, 3.0)
    for value, kind in enumerate(("off", "wrong", "stuck", "garbage", "failsafe"), 1):
        rig.boat.parameters.set("SIM_RC_FAIL", float(value))
        assert rig.world.electronics.faults.active["rc"].kind == kind
    rig.boat.parameters.set("SIM_RC_FAIL", 0.0)
    assert "rc" not in rig.world.electronics.faults.active


def test_a_restart_with_the_switch_up_does_not_arm() -> None:
    rig = under_way('faults=[{what="computer", at_s=9.0, for_s=1.0}]')
    rig.run(0.9)
    rig.reboot()
    rig.run(5.0)
    assert not rig.boat.vehicle.armed


def test_the_boat_does_not_arm_while_a_station_calibrates_the_transmitter() -> None:
    rig = Rig("open", KEYS, sticks(step(0.0, arm=ARM_DOWN), step(3.0), step(5.0, arm=ARM_DOWN), step(7.0)))
    rig.run(2.0)
    assert rig.ask(dialect.MAV_CMD_PREFLIGHT_CALIBRATION, 0, 0, 0, 1) == OK
    rig.run(2.0)
    assert "Arm: RC: being calibrated" in rig.peer.texts
    assert rig.ask(dialect.MAV_CMD_PREFLIGHT_CALIBRATION) == OK
    assert "Armed" not in rig.peer.texts
    rig.run(4.0)
    assert rig.boat.vehicle.armed
    assert rig.ask(dialect.MAV_CMD_PREFLIGHT_CALIBRATION, 0, 0, 0, 1) == REJECTED_FOR_NOW


def test_without_a_receiver_there_is_no_transmitter_to_calibrate() -> None:
    assert Rig().ask(dialect.MAV_CMD_PREFLIGHT_CALIBRATION, 0, 0, 0, 1) == UNSUPPORTED
