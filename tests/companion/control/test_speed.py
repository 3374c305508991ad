"""The speed loop against a hull whose steady speeds are known."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.tuning import Speed
from companion.control.pid import Pid
from companion.control.speed import ASTERN_SHARE, feed_forward, speed_effort

SETTING = Speed(cruise_m_s=2.0, cruise_throttle=0.6, kp=0.8, ki=0.2)


def test_feed_forward_passes_through_zero_and_cruise() -> None:
    assert feed_forward(0.0, SETTING) == 0.0
    assert feed_forward(2.0, SETTING) == pytest.approx(0.6)
    assert feed_forward(-1.0, SETTING) == pytest.approx(-0.3)


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
