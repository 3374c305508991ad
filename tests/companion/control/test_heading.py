"""The heading loop: the short way round, D from the measured rate, and the paper's three sets of gains."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.actuators import Handling
from companion.config.tuning import Heading
from companion.control.heading import heading_effort, learned_gains
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


@pytest.mark.parametrize(("accel", "damping"), [(0.65, 1.0 / 1.5), (0.4, 0.0), (1.3, 1.2)])
def test_poles_stay_where_the_configured_hull_has_them(accel: float, damping: float) -> None:
    """Kp b and Kd b + a are the square of the bandwidth and twice its damping."""
    handling, setting = Handling(turn_accel_rad_s2=0.65, turn_time_s=1.5), Heading(kp=3.0, ki=0.0, kd=2.0)
    schedule, more = learned_gains(accel, damping, handling)
    by_error = heading_effort(Pid(), 0.1, 0.0, 0.0, setting, 0.02, schedule=schedule, damping=more)
    by_rate = heading_effort(Pid(), 0.0, 0.0, 0.1, setting, 0.02, schedule=schedule, damping=more)
    assert by_error.total / 0.1 * accel == pytest.approx(3.0 * 0.65)
    assert -by_rate.total / 0.1 * accel + damping == pytest.approx(2.0 * 0.65 + 1.0 / 1.5)


def test_an_unknown_hull_has_the_configured_gains() -> None:
    assert learned_gains(0.0, 0.0, Handling(turn_accel_rad_s2=0.65)) == (1.0, 0.0)
    assert learned_gains(0.65, 0.3, Handling()) == (1.0, 0.0)
