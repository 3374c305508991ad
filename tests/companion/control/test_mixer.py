"""The mixer keeps yaw authority."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.control.mixer import mix
from companion.core.state import Thrust

share = st.floats(-1.0, 1.0)


@pytest.mark.parametrize(
    ("throttle", "steering", "left", "right"),
    [
        (0.0, 0.0, 0.0, 0.0),
        (0.5, 0.0, 0.5, 0.5),
        (0.5, 0.2, 0.7, 0.3),
        (0.0, -0.4, -0.4, 0.4),
        (1.0, 0.3, 1.0, 0.4),  # throttle gives way, the difference stays 2 × 0.3
        (-1.0, 0.3, -0.4, -1.0),
        (0.8, 1.0, 1.0, -1.0),
        (2.0, -3.0, -1.0, 1.0),
    ],
)
def test_mixes_as_a_table_says(throttle: float, steering: float, left: float, right: float) -> None:
    thrust = mix(throttle, steering)
    assert (thrust.left, thrust.right) == pytest.approx((left, right))


@given(share, share)
def test_yaw_is_never_given_up_and_nothing_saturates(throttle: float, steering: float) -> None:
    thrust = mix(throttle, steering)
    assert thrust.left - thrust.right == pytest.approx(2.0 * steering, abs=1e-12)
    assert max(abs(thrust.left), abs(thrust.right)) <= 1.0 + 1e-12
    mean = 0.5 * (thrust.left + thrust.right)
    assert abs(mean) <= abs(throttle) + 1e-12
    assert mean * throttle >= 0.0 or abs(mean) < 1e-12


@given(share, share)
def test_mirrored_steering_swaps_the_sides(throttle: float, steering: float) -> None:
    thrust = mix(throttle, steering)
    assert mix(throttle, -steering) == Thrust(thrust.right, thrust.left)


@pytest.mark.parametrize(("throttle", "steering"), [(math.nan, 0.0), (0.0, math.nan)])
def test_nan_goes_through_to_the_gate(throttle: float, steering: float) -> None:
    thrust = mix(throttle, steering)
    assert math.isnan(thrust.left)
    assert math.isnan(thrust.right)
