"""The modes that the operator's sticks steer through closed loops, on ground truth."""

import math

import pytest
from boat_rig import OK, Rig

from companion.core.units import wrap_pi
from companion.mavlink.dialect import dialect

ACRO, STEERING, SIMPLE = 1, 3, 7


def armed(mode: int, **config: object) -> Rig:
    rig = Rig(config={path.replace("__", "."): value for path, value in config.items()}).ready()
    assert rig.set_mode(mode) == OK
    assert rig.arm() == OK
    return rig


def push(rig: Rig, steering: int, throttle: int, seconds: float) -> None:
    for _ in range(round(seconds / 0.2)):
        rig.peer.send(dialect.MAVLink_manual_control_message(1, 0, steering, throttle, 0, 0))
        rig.run(0.2)


@pytest.mark.parametrize("side", [1, -1], ids=["starboard", "port"])
def test_acro_turns_at_the_rate_asked_for_and_holds_the_heading_when_let_go(side: int) -> None:
    rig = armed(ACRO)
    push(rig, side * 500, 300, 6.0)
    assert rig.world.truth.yaw_rate_rad_s == pytest.approx(side * 0.4, abs=0.08)
    push(rig, 0, 300, 8.0)
    heading_rad = rig.world.truth.heading_rad
    push(rig, 0, 300, 10.0)
    assert abs(wrap_pi(rig.world.truth.heading_rad - heading_rad)) < 0.05


def test_acro_holds_the_speed_that_the_throttle_asks_for() -> None:
    rig = armed(ACRO)
    push(rig, 0, 300, 15.0)  # cruise 2 m/s at 60 % throttle: 30 % is 1 m/s
    assert rig.world.truth.surge_m_s == pytest.approx(1.0, abs=0.15)


def test_steering_turns_wider_the_faster_the_boat_is() -> None:
    rates = []
    for throttle in (300, 600):
        rig = armed(STEERING)
        push(rig, 600, throttle, 12.0)
        rates.append(rig.world.truth.yaw_rate_rad_s)
        asked = 0.6 * rig.config.guidance.corner_accel_m_s2 / (throttle / 300.0)
        assert rates[-1] == pytest.approx(asked, rel=0.25)
    assert rates[0] > 1.5 * rates[1]


@pytest.mark.parametrize(
    ("simple_type", "steering", "throttle", "off_rad"),
    [
        (0, 0, 500, 0.0),
        (0, 500, 0, 0.5 * math.pi),
        (0, -350, -350, -0.75 * math.pi),
        (1, 500, 0, 0.5 * math.pi),
    ],
)
def test_simple_goes_where_the_stick_points(
    simple_type: int, steering: int, throttle: int, off_rad: float
) -> None:
    rig = armed(SIMPLE, modes__simple_type=simple_type)
    ahead_rad = rig.world.truth.heading_rad if simple_type == 0 else 0.0
    push(rig, steering, throttle, 15.0)
    assert wrap_pi(rig.world.truth.heading_rad - ahead_rad - off_rad) == pytest.approx(0.0, abs=0.1)
    assert rig.world.truth.surge_m_s > 0.8
    push(rig, 0, 0, 10.0)
    assert abs(rig.world.truth.surge_m_s) < 0.2
    assert wrap_pi(rig.world.truth.heading_rad - ahead_rad - off_rad) == pytest.approx(0.0, abs=0.15)


@pytest.mark.parametrize("mode", [ACRO, STEERING, SIMPLE])
def test_sticks_that_nobody_holds_stop_the_boat(mode: int) -> None:
    rig = armed(mode)
    push(rig, 0, 500, 5.0)
    rig.run(rig.config.failsafe.manual_timeout_s + 0.1)
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)
    assert rig.mode in ("ACRO", "STEERING", "SIMPLE")
