"""The speed loop against a hull whose steady speeds are known."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.tuning import Speed
from companion.control.pid import Pid
from companion.control.speed import ASTERN_SHARE, feed_forward, speed_effort

SETTING = Speed(cruise_m_s=2.0, cruise_throttle=0.6, kp=0.8, ki=0.2)


def _sail(
    demand_m_s: float, current_m_s: float, setting: Speed, seconds: float = 60.0
) -> tuple[float, float]:
    """Speed over ground and throttle after a while: thrust ∝ n², drag ∝ v² through the water."""
    control, water, throttle = Pid(), 0.0, 0.0
    for _ in range(round(seconds / 0.02)):
        throttle = speed_effort(control, demand_m_s, water + current_m_s, setting, 0.02).total
        balance = water * 0.3  # throttle that holds this speed
        water += 0.02 * 4.0 * (throttle * abs(throttle) - balance * abs(balance))
    return water + current_m_s, throttle


def test_feed_forward_passes_through_zero_and_cruise() -> None:
    assert feed_forward(0.0, SETTING) == 0.0
    assert feed_forward(2.0, SETTING) == pytest.approx(0.6)
    assert feed_forward(-1.0, SETTING) == pytest.approx(-0.3)


@pytest.mark.parametrize("current_m_s", [0.0, 0.5, -0.5])
@pytest.mark.parametrize("demand_m_s", [0.4, 1.0, 2.0])
def test_holds_the_speed_over_ground(demand_m_s: float, current_m_s: float) -> None:
    speed, _ = _sail(demand_m_s, current_m_s, SETTING)
    assert speed == pytest.approx(demand_m_s, abs=0.03)


def test_a_stop_is_helped_astern_but_not_with_full_power() -> None:
    out = speed_effort(Pid(), 0.0, 2.0, SETTING, 0.02)
    assert out.total == -ASTERN_SHARE
    assert out.saturated


def test_throttle_never_passes_its_limit_and_does_not_wind_up_there() -> None:
    setting = Speed(cruise_m_s=2.0, cruise_throttle=0.6, kp=0.8, ki=0.2, max_throttle=0.7)
    control = Pid()
    for _ in range(2000):
        assert speed_effort(control, 3.0, 1.0, setting, 0.02).total == pytest.approx(0.7)
    assert speed_effort(control, 1.0, 1.2, setting, 0.02).total < 0.3


def test_steering_that_leaves_no_room_leaves_the_integral_alone() -> None:
    control = Pid()
    for _ in range(500):
        assert speed_effort(control, 2.0, 0.5, SETTING, 0.02, room=0.0).total == 0.0
    assert speed_effort(control, 2.0, 2.0, SETTING, 0.02).i == pytest.approx(0.0, abs=1e-6)


@given(st.floats(-3.0, 3.0), st.floats(-4.0, 4.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_output_stays_in_the_room_there_is(demand: float, surge: float, room: float, limit: float) -> None:
    setting = Speed(max_throttle=limit)
    control = Pid()
    for _ in range(5):
        total = speed_effort(control, demand, surge, setting, 0.02, room).total
        assert -min(ASTERN_SHARE * limit, room) - 1e-12 <= total <= min(limit, room) + 1e-12


def test_astern_the_throttle_is_limited_to_half_of_that_ahead() -> None:
    assert speed_effort(Pid(), -10.0, 0.0, SETTING, 0.02).total == pytest.approx(-0.5)
    low = Speed(cruise_m_s=2.0, cruise_throttle=0.6, kp=0.8, ki=0.2, max_throttle=0.4)
    assert speed_effort(Pid(), -10.0, 0.0, low, 0.02).total == pytest.approx(-0.2)
    assert speed_effort(Pid(), 10.0, 0.0, low, 0.02).total == pytest.approx(0.4)


def test_a_known_current_is_fed_forward_so_that_the_integral_has_nothing_to_learn() -> None:
    for along_m_s in (0.5, -0.5):
        out = speed_effort(Pid(), 1.0, 1.0, SETTING, 0.02, current_m_s=along_m_s)
        assert out.total == pytest.approx(feed_forward(1.0 - along_m_s, SETTING))
        assert out.i == pytest.approx(0.0)
