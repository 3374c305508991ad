"""Modes on ground truth: LOITER, HOLD, GUIDED to a place, RTL, and those that sticks steer."""

import pytest
from boat_rig import OK, Rig
from sailing_rig import CURRENT, armed, drifted_m, go_to, push, told

from companion.core.modes import Mode
from companion.core.units import wrap_pi


def test_loiter_keeps_its_place_in_a_current_and_hold_drifts_without_thrust() -> None:
    rig = armed(Mode.LOITER, *CURRENT)
    assert drifted_m(rig, 40.0) < 3.0
    assert rig.mode == "LOITER"
    assert rig.set_mode(Mode.HOLD) == OK
    rig.run(15.0)
    before_m = rig.world.truth.east_m
    rig.run(20.0)
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)
    assert 7.0 < rig.world.truth.east_m - before_m < 11.0
    assert rig.world.truth.east_m_s == pytest.approx(0.5, abs=0.1)


def test_guided_arrives_in_a_current_and_rtl_comes_home_and_both_stay() -> None:
    rig = armed(Mode.GUIDED, *CURRENT)
    home = rig.world.truth
    go_to(rig, 20.0, -25.0)
    told(rig, "GUIDED: arrived", 60.0)
    assert rig.offset_m(20.0, -25.0) < 3.0
    assert drifted_m(rig, 20.0) < 3.0
    assert rig.set_mode(Mode.RTL) == OK
    told(rig, "RTL: arrived", 80.0)
    rig.run(20.0)
    assert rig.mode == "RTL"
    assert rig.offset_m(home.north_m, home.east_m) < 3.0


def stale(rig: Rig) -> bool:
    """Whether motors stop once nobody holds the sticks."""
    rig.run(rig.config.failsafe.manual_timeout_s + 0.5)
    return (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)


def test_manual_turns_and_drives_as_the_stick_is_pushed_until_it_is_let_go() -> None:
    rig = armed(Mode.MANUAL)
    for side in (1, -1):
        push(rig, side * 400, 300, 3.0)
        assert side * rig.world.truth.yaw_rate_rad_s > 0.1
    push(rig, 0, 600, 5.0)
    assert rig.world.truth.surge_m_s > 1.0
    push(rig, 0, -600, 8.0)
    assert rig.world.truth.surge_m_s < -0.3
    assert stale(rig)


def test_acro_turns_at_the_rate_asked_for_and_holds_heading_and_speed() -> None:
    rig = armed(Mode.ACRO)
    for side in (1, -1):
        push(rig, side * 500, 300, 6.0)
        assert rig.world.truth.yaw_rate_rad_s == pytest.approx(side * 0.4, abs=0.08)
    push(rig, 0, 300, 8.0)
    heading_rad = rig.world.truth.heading_rad
    push(rig, 0, 300, 8.0)
    assert abs(wrap_pi(rig.world.truth.heading_rad - heading_rad)) < 0.05
    assert rig.world.truth.surge_m_s == pytest.approx(1.0, abs=0.15)  # cruise 2 m/s at 60 %: 30 % is 1 m/s
    assert stale(rig)
    assert rig.mode == "ACRO"
