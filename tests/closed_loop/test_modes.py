"""Each mode on ground truth: the real boat in lockstep with simulated water."""

import math

import pytest
from boat_rig import OK, Rig

from companion.core.units import wrap_pi
from companion.mavlink.dialect import Message, dialect

CURRENT = ("environment.current_m_s=0.5", "environment.current_to_deg=90.0")


def armed(rig: Rig, mode: int) -> Rig:
    rig.ready()
    assert rig.set_mode(mode) == OK
    assert rig.arm() == OK
    return rig


def go_to(rig: Rig, north_m: float, east_m: float) -> None:
    frame, start = rig.scenario.frame, rig.scenario.start
    there = frame.to_global(start._replace(north_m=north_m, east_m=east_m))
    x, y = round(there.lat_deg * 1e7), round(there.lon_deg * 1e7)
    rig.peer.forget()
    rig.peer.command_int(192, -1, 1, 0, math.nan, x=x, y=y)
    rig.receive()
    assert [ack.result for ack in rig.peer.said("COMMAND_ACK")] == [OK]


def test_loiter_stays_within_three_metres_in_half_a_metre_a_second() -> None:
    rig = armed(Rig("open", *CURRENT), 5)
    truth = rig.world.truth
    worst_m = 0.0
    for _ in range(60):
        rig.run(1.0)
        worst_m = max(worst_m, rig.offset_m(truth.north_m, truth.east_m))
    assert rig.mode == "LOITER"
    assert worst_m < 3.0


def test_hold_gives_no_thrust_and_drifts_with_the_water() -> None:
    rig = armed(Rig("open", *CURRENT), 5)
    rig.run(10.0)
    assert rig.set_mode(4) == OK
    rig.run(2.0)
    before_m = rig.world.truth.east_m
    rig.run(60.0)
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)
    assert 15.0 < rig.world.truth.east_m - before_m < 30.0
    assert rig.world.truth.east_m_s == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("setting", [(), CURRENT], ids=["calm", "current"])
def test_guided_arrives_and_stays(setting: tuple[str, ...]) -> None:
    rig = armed(Rig("open", *setting), 15)
    go_to(rig, 30.0, -40.0)
    rig.until(lambda: any("GUIDED: arrived" in text for text in rig.peer.texts), 60.0)
    assert rig.offset_m(30.0, -40.0) < 3.0
    rig.run(30.0)
    assert rig.offset_m(30.0, -40.0) < 3.0
    go_to(rig, 0.0, 0.0)
    rig.until(lambda: rig.offset_m(0.0, 0.0) < 2.5, 60.0)


@pytest.mark.parametrize("setting", [(), CURRENT], ids=["calm", "current"])
def test_rtl_comes_home_and_stays_there(setting: tuple[str, ...]) -> None:
    rig = armed(Rig("open", *setting), 15)
    home = rig.world.truth
    go_to(rig, 40.0, 30.0)
    rig.until(lambda: rig.offset_m(40.0, 30.0) < 5.0, 60.0)
    assert rig.set_mode(11) == OK
    rig.until(lambda: any("RTL: arrived" in text for text in rig.peer.texts), 80.0)
    rig.run(30.0)
    assert rig.mode == "RTL"
    assert rig.offset_m(home.north_m, home.east_m) < 3.0


def sticks(steering: int, throttle: int) -> Message:
    message: Message = dialect.MAVLink_manual_control_message(1, 0, steering, throttle, 0, 0)
    return message


def drive(rig: Rig, steering: int, throttle: int, seconds: float) -> None:
    for _ in range(round(seconds / 0.2)):
        rig.peer.send(sticks(steering, throttle))
        rig.run(0.2)


@pytest.mark.parametrize("side", [1, -1], ids=["starboard", "port"])
def test_the_stick_turns_the_boat_the_way_it_is_pushed(side: int) -> None:
    rig = armed(Rig(), 0)
    before = rig.world.truth.heading_rad
    drive(rig, side * 400, 300, 2.0)
    assert side * wrap_pi(rig.world.truth.heading_rad - before) > 0.1
    assert side * rig.world.truth.yaw_rate_rad_s > 0.1


def test_the_stick_drives_ahead_and_astern_and_goes_stale_when_nobody_holds_it() -> None:
    rig = armed(Rig(), 0)
    drive(rig, 0, 600, 5.0)
    assert rig.world.truth.surge_m_s > 1.0
    drive(rig, 0, -600, 8.0)
    assert rig.world.truth.surge_m_s < -0.3
    rig.run(rig.config.failsafe.manual_timeout_s + 0.5)
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)


def test_a_silent_operator_makes_the_boat_loiter_where_it_is_missed() -> None:
    rig = armed(Rig("open", *CURRENT), 15)
    go_to(rig, 200.0, 0.0)
    rig.peer.heartbeat()
    rig.until(lambda: rig.mode == "LOITER", 10.0)
    north_m, east_m = rig.world.truth.north_m, rig.world.truth.east_m
    rig.run(60.0)
    assert rig.offset_m(north_m, east_m) < 6.0
