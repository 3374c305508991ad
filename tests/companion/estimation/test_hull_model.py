"""How thrust and steering move the modelled hull."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.actuators import DriveSetting, Handling
from companion.config.tuning import Estimation, Speed
from companion.core.state import MotorCommand
from companion.estimation.hull_model import SurgeModel
from companion.estimation.nominal_state import NominalState

TICK_S = 0.04


def sailed(
    model: SurgeModel, ticks: int, throttle: float, rate: float = 0.0, surge_m_s: float = 0.0
) -> float:
    """The surge after so many ticks."""
    for _ in range(ticks):
        surge_m_s = model.advance(surge_m_s, rate, throttle, throttle, 1.0, TICK_S)
    return surge_m_s


def test_cruise_throttle_leads_to_cruise_speed_and_a_turn_slows_and_slides() -> None:
    model = SurgeModel(2.0, 0.6, 3.0)
    surge_m_s = sailed(model, 1500, 0.6)
    assert surge_m_s == pytest.approx(2.0, abs=0.01)
    assert model.sway_m_s == 0.0
    assert sailed(model, 50, 0.6, 0.5, surge_m_s) < 1.9
    assert -0.6 < model.sway_m_s < -0.1, "to starboard turned, to port slid"


def test_the_gain_scales_the_thrust() -> None:
    weak, surge_m_s = SurgeModel(2.0, 0.6, 3.0), 0.0
    for _ in range(3000):
        surge_m_s = weak.advance(surge_m_s, 0.0, 0.6, 0.6, 0.7, TICK_S)
    assert 1.4 < surge_m_s < 1.8
    assert weak.accel_m_s2 == pytest.approx(0.0, abs=1e-6)
    more = SurgeModel(2.0, 0.6, 3.0)
    more.advance(surge_m_s, 0.0, 0.6, 0.6, 0.8, TICK_S)
    assert more.accel_m_s2 == pytest.approx(0.1 * weak.per_gain, rel=0.05)
    more.advance(surge_m_s, 0.0, 0.6, 0.6, 0.8, 0.0)
    assert more.accel_m_s2 == 0.0


def test_without_a_throttle_for_cruise_there_is_drag_but_no_thrust() -> None:
    model = SurgeModel(2.0, 0.0, 3.0)
    assert model.advance(0.0, 0.5, 1.0, 1.0, 1.0, TICK_S) == 0.0
    assert 0.4 < model.advance(1.0, 0.0, 1.0, 1.0, 1.0, 3.0) < 0.8, "drag alone, in one long step"
    assert model.per_gain == 0.0


@given(
    st.lists(st.tuples(*[st.floats(-1.0, 1.0)] * 2, st.floats(-3.0, 3.0), st.floats(0.001, 5.0)), max_size=50)
)
def test_the_speed_stays_within_reason(steps: list[tuple[float, float, float, float]]) -> None:
    model, surge_m_s = SurgeModel(2.0, 0.05, 0.1), 0.0
    for left, right, rate, dt in steps:
        surge_m_s = model.advance(surge_m_s, rate, left, right, 1.0, dt)
        assert math.hypot(surge_m_s, model.sway_m_s) <= 41.0, (
            "no throttle is more than twenty times that of cruise"
        )


def test_a_rudder_turns_a_boat_under_way_and_not_one_at_rest() -> None:
    rates = []
    for speed_m_s in (0.0, 2.0):
        state = NominalState(Speed(), Estimation(), DriveSetting(wash=0.0), Handling())
        state.has_heading, state.surge_m_s = True, speed_m_s
        for tick in range(1, 20):
            state.move(TICK_S * tick, MotorCommand(0.0, 0.0, rudder=0.5))
        rates.append(state.yaw_rate_rad_s)
    assert abs(rates[0]) < 1e-6
    assert rates[1] > 0.05


@pytest.mark.parametrize(("turn_s", "motor_s"), [(0.8, 0.15), (2.0, 0.15), (0.8, 0.6)])
def test_the_rate_follows_steering_with_the_configured_delays(turn_s: float, motor_s: float) -> None:
    """Two first-order lags in a row: their mean delays add up."""
    handling = Handling(turn_time_s=turn_s, motor_time_s=motor_s)
    model = NominalState(Speed(), Estimation(), DriveSetting(), handling).yaw_model
    missing = 0.0
    for _ in range(2000):
        model.advance(1.0, -1.0, 0.0, 0.01)
        missing += 0.01 * (1.0 - model.turning)
    assert missing == pytest.approx(turn_s + motor_s, abs=0.03)  # two Euler steps less
