"""The heading loop: the short way round, D from the measured rate, and the paper's three sets of gains."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.tuning import Heading
from companion.control.heading import heading_effort
from companion.control.pid import Pid
from companion.core.units import wrap_pi

P_ONLY = Heading(kp=0.1, ki=0.0, kd=0.0)


@pytest.mark.parametrize(
    ("demand_deg", "heading_deg", "error_deg"),
    [
        (10, 0, 10),
        (0, 10, -10),
        (179, -179, -2),
        (-179, 179, 2),
        (350, 0, -10),
        (90, -80, 170),
        (90, -100, -170),
    ],
)
def test_turns_the_short_way(demand_deg: float, heading_deg: float, error_deg: float) -> None:
    out = heading_effort(Pid(), math.radians(demand_deg), math.radians(heading_deg), 0.0, P_ONLY, 0.02)
    assert out.total == pytest.approx(0.1 * math.radians(error_deg))


def test_the_derivative_brakes_a_turn_and_never_sees_the_wrap() -> None:
    control = Pid()
    setting = Heading(kp=0.0, ki=0.0, kd=0.5)
    for heading in (3.1, 3.14, -3.14, -3.1):
        assert heading_effort(control, -3.0, heading, 0.2, setting, 0.02).d == pytest.approx(-0.1)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("fed", [0.0, 0.4, -0.4])
def test_steering_stays_within_its_share_whatever_is_fed_forward(side: float, fed: float) -> None:
    setting = Heading(kp=9.0, max_steering=0.6)
    out = heading_effort(Pid(), 1.5 * side, 0.0, 0.0, setting, 0.02, feed_forward=fed)
    assert out.total == pytest.approx(0.6 * side)
    assert out.saturated


@given(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
def test_whole_turns_make_no_difference(demand: float, heading: float) -> None:
    error = wrap_pi(demand - heading)
    if abs(abs(error) - math.pi) < 1e-6:
        return
    plain = heading_effort(Pid(), demand, heading, 0.0, P_ONLY, 0.02).total
    turned = heading_effort(Pid(), demand + 4 * math.pi, heading - 2 * math.pi, 0.0, P_ONLY, 0.02).total
    assert turned == pytest.approx(plain, abs=1e-9)


def _step_response(kp: float, ki: float, kd: float, step_rad: float = 1.0) -> list[float]:
    """First-order Nomoto hull, T r' + r = K δ, of the pool boat's size: heading over 30 s at 50 Hz."""
    gain_rad_s, lag_s, dt_s = 0.8, 1.2, 0.02
    setting, control = Heading(kp=kp, ki=ki, kd=kd), Pid()
    heading, rate, track = 0.0, 0.0, []
    for _ in range(1500):
        steering = heading_effort(control, step_rad, heading, rate, setting, dt_s).total
        rate += dt_s * (gain_rad_s * steering - rate) / lag_s
        heading += dt_s * rate
        track.append(heading / step_rad)
    return track


def _overshoot_and_settling_s(track: list[float]) -> tuple[float, float]:
    last = max((tick for tick, value in enumerate(track) if abs(value - 1.0) > 0.05), default=0)
    return max(track) - 1.0, last * 0.02


@pytest.mark.parametrize("gains", [(3.0, 2.0, 3.0), (4.0, 1.0, 5.0), (4.5, 2.3, 1.0), (2.5, 0.15, 1.8)])
def test_the_papers_gains_and_ours_settle_without_swinging(gains: tuple[float, float, float]) -> None:
    track = _step_response(*gains)
    overshoot, settling_s = _overshoot_and_settling_s(track)
    assert overshoot < 0.35
    assert settling_s < 12.0
    assert track[-1] == pytest.approx(1.0, abs=0.02)


def _integral(control: Pid, setting: Heading) -> float:
    return heading_effort(control, 0.0, 0.0, 0.0, setting, 0.0).i


def test_the_integral_learns_nothing_while_the_boat_turns_onto_a_heading() -> None:
    control, setting = Pid(), Heading(kp=2.0, ki=1.0, kd=2.0)
    for _ in range(50):
        heading_effort(control, 1.0, 0.0, 0.0, setting, 0.02)  # far off
        heading_effort(control, 0.1, 0.0, 0.3, setting, 0.02)  # near, and turning
        heading_effort(control, 0.1, 0.0, 0.0, setting, 0.02, demand_rate_rad_s=0.3)  # on an arc
    assert _integral(control, setting) == 0.0
    for _ in range(50):
        heading_effort(control, 0.1, 0.0, 0.0, setting, 0.02)
    assert _integral(control, setting) == pytest.approx(0.1)


def test_a_turn_makes_the_integral_forget_and_a_rate_that_is_no_number_too() -> None:
    control, setting = Pid(), Heading(kp=2.0, ki=1.0, kd=2.0)
    for rate in (1.0, math.nan):
        for _ in range(50):
            heading_effort(control, 0.1, 0.0, 0.0, setting, 0.02)
        for _ in range(75):  # 1.5 rad
            heading_effort(control, 0.1, 0.0, rate, setting, 0.02)
        assert abs(_integral(control, setting)) < 0.005


def test_without_a_band_the_integral_learns_in_turns_too() -> None:
    control, setting = Pid(), Heading(kp=2.0, ki=1.0, kd=2.0, integral_band_rad=0.0)
    for _ in range(50):
        heading_effort(control, 0.2, 0.0, 0.3, setting, 0.02)
    assert _integral(control, setting) == pytest.approx(0.2)
