"""A boat with a transmitter, in lockstep: sticks by schedule, faults, and what stations see of it."""

import pytest
from boat_rig import OK, Rig
from sailing_rig import drifted_m, speed_m_s, tells

from companion.core.units import wrap_pi
from companion.mavlink.dialect import dialect

ARM_UP, ARM_DOWN = 2000, 1000
MANUAL, HOLD, LOITER, AUTO = 1100, 1300, 1425, 1550
REST = 1500
RC_BIT = dialect.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
KEYS = "vehicle.rc={arm_channel=5, mode_channel=6}"


def step(
    at_s: float, throttle: int = REST, steering: int = REST, arm: int = ARM_UP, mode: int = MANUAL
) -> str:
    return f"{{at_s={at_s}, channels=[{steering}, 1500, {throttle}, 1500, {arm}, {mode}, 1500, 1500]}}"


def sticks(*steps: str) -> str:
    return f"sensors.rc={{fitted=true, sticks=[{', '.join(steps)}]}}"


def under_way(*settings: str) -> Rig:
    """Armed by the switch, full ahead in MANUAL since 4 s."""
    rig = Rig("open", KEYS, sticks(step(0.0, arm=ARM_DOWN), step(3.0), step(4.0, throttle=2000)), *settings)
    rig.run(8.0)
    assert rig.boat.vehicle.armed
    assert rig.mode == "MANUAL"
    assert speed_m_s(rig) > 1.0
    return rig


def test_a_hand_on_shore_arms_sails_out_turns_and_disarms_without_any_station() -> None:
    steps = (
        step(0.0, arm=ARM_DOWN), step(3.0), step(4.0, throttle=2000),
        step(11.0, throttle=1800, steering=1900), step(14.0), step(15.0, arm=ARM_DOWN),
    )  # fmt: skip
    rig = Rig("open", KEYS, sticks(*steps))
    rig.run(10.9)
    assert rig.offset_m(rig.scenario.start.north_m, rig.scenario.start.east_m) > 7.0
    ahead_rad = rig.world.truth.heading_rad
    rig.run(2.0)
    assert wrap_pi(rig.world.truth.heading_rad - ahead_rad) > 0.3  # to starboard
    rig.run(3.0)
    assert not rig.boat.vehicle.armed
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)
    assert rig.peer.texts[-1] == "Disarmed by the arming switch"


@pytest.mark.parametrize("kind", ["off", "failsafe", "garbage"])
def test_a_boat_by_hand_keeps_station_where_it_lost_its_transmitter(kind: str) -> None:
    rig = under_way(f'faults=[{{what="rc", kind="{kind}", at_s=10.0}}]')
    rig.run(2.0)
    assert rig.until(lambda: rig.mode == "LOITER", 4.0) < 2.7
    assert tells(rig, "Failsafe: RC lost:")
    rig.peer.forget()
    rig.run(15.0)
    assert drifted_m(rig, 15.0) < 3.0
    channels, status = rig.peer.said("RC_CHANNELS")[-1], rig.peer.said("SYS_STATUS")[-1]
    if kind == "off":
        assert (channels.chancount, channels.rssi, channels.chan1_raw) == (0, 0, 0xFFFF)
    assert status.onboard_control_sensors_present & RC_BIT
    assert not status.onboard_control_sensors_health & RC_BIT


def test_the_helm_follows_in_three_ticks_and_frozen_sticks_look_held_until_a_station_stops_the_boat() -> None:
    rig = under_way('faults=[{what="rc", kind="stuck", at_s=10.0}]')
    radio = rig.world.electronics.rc
    assert radio is not None
    rig.run(1.0)
    radio.hold((1500, 1500, 1000, 1500, ARM_UP, MANUAL))
    rig.step(3)
    assert rig.boat.command.left < 1.0
    rig.run(6.0)
    assert rig.mode == "MANUAL"
    assert rig.world.truth.surge_m_s < -0.3
    assert rig.set_mode(4) == OK
    rig.run(3.0)
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)
