"""Circle guidance: on the circle along its tangent with the lead of the hull, off it back to it."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig, with_value
from companion.core.geo import Point
from companion.core.intent import FollowCircle
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.guidance.circle import circle_course_rad, circle_speed_m_s

CONFIG = BoatConfig()
CENTRE = Point(100.0, -40.0)


def nav_on(
    bearing: float, radius_m: float, speed_m_s: float = 0.0, course: float = 0.0, heading: float = 0.0
) -> NavState:
    north, east = (
        CENTRE.north_m + radius_m * math.cos(bearing),
        CENTRE.east_m + radius_m * math.sin(bearing),
    )
    return NavState(
        0.0, north, east, heading, 0.0, speed_m_s * math.cos(course), speed_m_s * math.sin(course),
        0.0, 0.0, 0.1, 0.1,
    )  # fmt: skip


def lead_rad(radius_m: float, speed_m_s: float) -> float:
    """The arc that hull and heading loop lag behind."""
    return (CONFIG.handling.slip_m + CONFIG.handling.yaw_time_s * speed_m_s) / radius_m


@given(st.floats(-math.pi, math.pi), st.booleans(), st.floats(0.0, 2.0))
def test_on_the_circle_the_course_is_the_tangent_ahead(bearing: float, clockwise: bool, speed: float) -> None:
    side = 1.0 if clockwise else -1.0
    tangent = bearing + side * math.pi / 2.0
    circle = FollowCircle(CENTRE, 20.0, clockwise, 1.0)
    course, cross_m, rate = circle_course_rad(circle, nav_on(bearing, 20.0, speed, tangent), CONFIG)
    assert wrap_pi(course - tangent - side * lead_rad(20.0, speed)) == pytest.approx(0.0, abs=1e-6)
    assert cross_m == pytest.approx(0.0, abs=1e-6)
    assert rate == pytest.approx(side * speed / 20.0)


def test_half_a_radius_off_half_of_the_curvature_counts_and_a_radius_off_none() -> None:
    circle = FollowCircle(CENTRE, 20.0, True, 1.0)
    for radius_m, share in ((30.0, 0.5), (10.0, 0.5), (40.0, 0.0), (60.0, 0.0)):
        _, _, rate = circle_course_rad(circle, nav_on(0.3, radius_m, 2.0, 0.0), CONFIG)
        assert rate == pytest.approx(share * 2.0 / 20.0)


def test_a_small_circle_is_led_by_a_radian_at_most() -> None:
    assert lead_rad(0.2, 2.0) > 1.0
    course, _, _ = circle_course_rad(
        FollowCircle(CENTRE, 0.2, True, 1.0), nav_on(0.0, 0.2, 2.0, math.pi / 2.0), CONFIG
    )
    assert course == pytest.approx(math.pi / 2.0 + 1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("radius_m", "asked_m_s", "speed_m_s"),
    [
        (5.0, 3.0, 2.0),  # √(0.8 × 5)
        (5.0, 1.5, 1.5),
        (0.05, 3.0, 0.4),  # √0.04 is less than steerage way
        (0.05, 0.3, 0.3),
    ],
)
def test_the_speed_is_what_the_lateral_acceleration_allows(
    radius_m: float, asked_m_s: float, speed_m_s: float
) -> None:
    config = with_value(CONFIG, "guidance.corner_accel_m_s2", 0.8)
    circle = FollowCircle(CENTRE, radius_m, True, asked_m_s)
    assert circle_speed_m_s(circle, config) == pytest.approx(speed_m_s)
