"""The filter's arithmetic, without parts: signs, gaps, what it trusts."""

import math

import pytest

from companion.core.vectors import Vector, product, quarter_turns, times
from companion.sensors.compass.attitude import AttitudeFilter, level_field, magnetic_heading, roll_pitch
from companion.sensors.compass.magnetic_field import BY_CURRENT, BY_THROTTLE, NO_MOTORS, MotorLoad

LEVEL: Vector = (0.0, 0.0, 1.0)
REST: Vector = (0.0, 0.0, -9.81)


def down(roll_deg: float, pitch_deg: float) -> Vector:
    roll, pitch = math.radians(roll_deg), math.radians(pitch_deg)
    return -math.sin(pitch), math.cos(pitch) * math.sin(roll), math.cos(pitch) * math.cos(roll)


@pytest.mark.parametrize(("roll_deg", "pitch_deg"), [(0.0, 0.0), (20.0, -10.0), (-170.0, 5.0), (90.0, 0.0)])
def test_roll_and_pitch_follow_from_the_direction_of_gravity(roll_deg: float, pitch_deg: float) -> None:
    roll, pitch = roll_pitch(down(roll_deg, pitch_deg))
    assert (math.degrees(roll), math.degrees(pitch)) == pytest.approx((roll_deg, pitch_deg))


def test_a_field_to_port_is_an_easterly_heading_and_the_vertical_part_does_not_count() -> None:
    assert magnetic_heading((0.0, -200.0, 440.0), LEVEL) == pytest.approx(math.pi / 2)
    assert magnetic_heading((0.0, 0.0, 440.0), LEVEL) is None
    assert level_field((200.0, 0.0, 440.0), (-1.0, 0.0, 0.0)) is None  # the bow points straight up


def filled(rate: Vector = (0.0, 0.0, 0.0), seconds: float = 12.0, force: Vector = REST) -> AttitudeFilter:
    filter_ = AttitudeFilter()
    for step in range(round(seconds / 0.02) + 1):
        filter_.turn(rate, force, 0.02 * step)
        filter_.point((200.0, 0.0, 440.0), 0.02 * step)
    return filter_


def test_clockwise_turns_are_positive_and_carry_the_heading_without_a_field() -> None:
    filter_ = filled()
    for step in range(50):
        filter_.turn((0.0, 0.0, 0.3), REST, 12.02 + 0.02 * step)
    assert filter_.attitude is not None
    assert filter_.attitude.heading_rad == pytest.approx(0.3, abs=1e-3)
    assert filter_.attitude.yaw_rate_rad_s == pytest.approx(0.3, abs=1e-3)


def test_a_rate_without_a_turn_of_the_field_is_a_bias() -> None:
    filter_ = filled((0.0, 0.0, 0.2), seconds=20.0)
    assert filter_.bias[2] == pytest.approx(0.2, abs=0.02)
    assert abs(filter_.yaw_rate_rad_s) < 0.02


def test_a_heel_without_a_rate_is_followed_slowly_and_not_in_a_turn() -> None:
    tilted = tuple(-9.81 * one for one in down(5.0, 0.0))
    for rate, least_deg, most_deg in ((0.0, 0.5, 1.5), (0.5, -0.05, 0.05)):
        filter_ = filled()
        for step in range(50):
            filter_.turn((0.0, 0.0, rate), (tilted[0], tilted[1], tilted[2]), 12.02 + 0.02 * step)
        assert least_deg < math.degrees(roll_pitch(filter_.down)[0]) < most_deg


def test_shocks_do_not_move_the_horizon() -> None:
    filter_ = filled()
    for step in range(20):
        filter_.turn((0.0, 0.0, 0.0), (0.0, -9.81, -9.81), 12.02 + 0.02 * step)
    assert roll_pitch(filter_.down)[0] == pytest.approx(0.0, abs=1e-6)


def test_quarter_turns_are_exact_and_chain_in_the_order_roll_pitch_yaw() -> None:
    assert times(quarter_turns(0, 0, 1), (1.0, 0.0, 0.0)) == (0.0, 1.0, 0.0)  # ahead to starboard
    assert times(quarter_turns(0, 1, 0), (1.0, 0.0, 0.0)) == (0.0, 0.0, -1.0)  # bow up
    assert times(quarter_turns(1, 0, 0), (0.0, 1.0, 0.0)) == (0.0, 0.0, 1.0)  # starboard down
    assert quarter_turns(1, 2, 3) == product(
        quarter_turns(0, 0, 3), product(quarter_turns(0, 2, 0), quarter_turns(1, 0, 0))
    )


@pytest.mark.parametrize(("source", "load"), [(BY_THROTTLE, 0.5), (BY_CURRENT, 4.0), (NO_MOTORS, 0.0)])
def test_the_motors_load_is_that_of_its_source_and_zero_where_it_is_not_measured(
    source: int, load: float
) -> None:
    assert MotorLoad(0.5, 4.0).of(source) == load
    assert MotorLoad(0.5).of(source) == (0.5 if source == BY_THROTTLE else 0.0)
