"""What a motor is told for a share of thrust."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.thrusters import Thrusters
from companion.control.thruster_trim import FAINT, ThrusterTrim, share_of, told
from companion.core.state import MotorCommand

SHARES = st.floats(-1.0, 1.0)
BANDS = st.floats(0.0, 0.6)
GAINS = st.floats(0.2, 1.0)
ASYMMETRIES = st.floats(1.0, 10.0)


def test_a_boat_that_was_never_calibrated_gets_its_commands_unchanged() -> None:
    trim = ThrusterTrim()
    trim.update(MotorCommand(0.123456789, -0.987654321), Thrusters())
    assert (trim.left, trim.right) == (0.123456789, -0.987654321)


def test_a_bare_command_goes_past_the_trim_and_the_next_one_does_not() -> None:
    trim, setting = ThrusterTrim(), Thrusters(left_ahead=0.1, right_gain=0.5)
    trim.update(MotorCommand(0.5, 0.5), setting, is_bare=True)
    assert (trim.left, trim.right) == (0.5, 0.5)
    trim.update(MotorCommand(0.5, 0.5), setting)
    assert (trim.left, trim.right) == pytest.approx((0.55, 0.25))


def test_each_side_has_its_own_dead_band_ahead_and_astern() -> None:
    setting = Thrusters(left_ahead=0.1, left_astern=0.2, right_ahead=0.3, right_astern=0.4, asymmetry=1.25)
    trim = ThrusterTrim()
    trim.update(MotorCommand(0.4, 0.4), setting)
    assert (trim.left, trim.right) == pytest.approx((0.46, 0.58))
    trim.update(MotorCommand(-0.4, -0.4), setting)
    assert (trim.left, trim.right) == pytest.approx((-0.6, -0.7))


def test_a_changed_setting_counts_at_the_next_command() -> None:
    trim = ThrusterTrim()
    trim.update(MotorCommand(1.0, 1.0), Thrusters(left_gain=0.8))
    trim.update(MotorCommand(1.0, 1.0), Thrusters(left_gain=0.6))
    assert trim.left == pytest.approx(0.6)
    trim.update(MotorCommand(1.0, 1.0), Thrusters())
    assert trim.left == 1.0


@given(BANDS, BANDS, GAINS, ASYMMETRIES)
def test_nothing_stays_nothing(ahead: float, astern: float, gain: float, asymmetry: float) -> None:
    assert told(0.0, ahead, astern, gain, asymmetry) == 0.0
    assert told(float("nan"), ahead, astern, gain, asymmetry) == 0.0


@given(SHARES, BANDS, BANDS, GAINS, ASYMMETRIES)
def test_a_motor_turns_the_way_it_is_asked_to_and_never_beyond_its_full_command(
    share: float, ahead: float, astern: float, gain: float, asymmetry: float
) -> None:
    command = told(share, ahead, astern, gain, asymmetry)
    assert command * share >= 0.0
    assert abs(command) <= 1.0 + 1e-12


@given(SHARES, SHARES, BANDS, BANDS, GAINS, ASYMMETRIES)
def test_more_thrust_never_takes_less_command(
    one: float, other: float, ahead: float, astern: float, gain: float, asymmetry: float
) -> None:
    less, more = sorted((one, other))
    assert told(less, ahead, astern, gain, asymmetry) <= told(more, ahead, astern, gain, asymmetry) + 1e-12


@given(st.floats(FAINT, 1.0), BANDS, GAINS)
def test_the_share_is_had_back_from_the_command(share: float, band: float, gain: float) -> None:
    assert share_of(told(share, band, 0.0, gain, 1.0), band, gain) == pytest.approx(share, abs=1e-9)
