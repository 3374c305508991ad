"""Allocation by the layout: the rudder's angle for a moment, and who gives how much of it."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig, decode_config, with_value
from companion.control.allocation import Effort, allocate, by_hand, rudder_effect
from companion.core.state import Thrust

SHARES = st.floats(-1.0, 1.0)
SPEEDS = st.floats(-3.0, 3.0)


def config(layout: str = "rudder", **drive: float) -> BoatConfig:
    """A boat that cruises at 1 m/s with half throttle."""
    figures = {"wash": 0.4, "astern": 0.25, "steerage_m_s": 0.5, "kick_throttle": 0.6, **drive}
    speed = {"cruise_m_s": 1.0, "cruise_throttle": 0.5}
    return decode_config({"drive": {"layout": layout, **figures}, "speed": speed}, "test")


def effect_of(setting: BoatConfig, throttle: float, water_m_s: float) -> float:
    return rudder_effect(throttle, water_m_s, setting.drive, setting.speed)


@pytest.mark.parametrize(
    ("throttle", "water_m_s", "effect"),
    [
        (0.5, 1.0, 1.0),  # at cruise
        (0.0, 1.0, 0.6),  # coasting: the water's own speed
        (0.5, 0.0, 0.4),  # at rest: the wash
        (1.0, 2.0, 4.0),  # all speeds doubled
        (0.0, -1.0, -0.15),  # astern: a quarter, and the other way
        (-0.5, -1.0, -0.15),  # a propeller astern sends no wash aft
        (0.5, -1.0, 0.25),  # the wash outweighs the way astern
    ],
)
def test_the_rudders_effect_is_the_square_of_the_speed_at_the_blade(
    throttle: float, water_m_s: float, effect: float
) -> None:
    assert effect_of(config(), throttle, water_m_s) == pytest.approx(effect)
    faster = with_value(config(), "speed.cruise_m_s", 2.0)
    assert effect_of(faster, throttle, 2.0 * water_m_s) == pytest.approx(effect)


@pytest.mark.parametrize(
    ("surge", "yaw", "water_m_s", "rudder"),
    [
        (0.5, 0.3, 1.0, 0.3),
        (0.5, -0.3, 1.0, -0.3),
        (1.0, 0.8, 2.0, 0.2),  # four times the effect
        (0.0, 0.3, 1.0, 0.5),
        (-0.4, 0.06, -1.0, -0.4),  # astern the sign turns
        (0.5, 5.0, 1.0, 1.0),  # the linkage ends before the stall
        (0.0, 0.02, 0.0, 0.4),  # no flow: a limited angle, not a division by nothing
    ],
)
def test_the_angle_gives_the_moment(surge: float, yaw: float, water_m_s: float, rudder: float) -> None:
    thrust = allocate(Effort(surge, yaw, water_m_s), config())
    assert thrust.rudder == pytest.approx(rudder)
    assert thrust.left == thrust.right == pytest.approx(surge)


@given(SHARES, SHARES, SPEEDS)
def test_within_its_limits_the_rudder_gives_exactly_the_moment(
    surge: float, yaw: float, water_m_s: float
) -> None:
    setting = config()
    thrust = allocate(Effort(surge, yaw, water_m_s), setting)
    effect = effect_of(setting, thrust.left, water_m_s)
    assert abs(thrust.rudder) <= 1.0
    if abs(thrust.rudder) < 1.0 and abs(effect) > 0.05:
        assert thrust.rudder * effect == pytest.approx(yaw, abs=1e-9)


@pytest.mark.parametrize(
    ("surge", "yaw", "water_m_s", "throttle"),
    [
        (0.1, 0.4, 0.0, 0.5),  # the wash for 0.4 of the moment at cruise: √(0.4 / 0.4) of cruise throttle
        (0.1, 0.1, 0.0, 0.25),
        (0.1, 1.0, 0.0, 0.6),  # as far as the kick goes
        (0.1, 0.4, 0.25, 0.25),  # half of it at half of steerage way,
        (0.1, 0.4, 0.5, 0.1),  # none from there on
        (0.8, 0.4, 0.0, 0.8),  # the throttle is high enough
        (0.0, 0.4, 0.0, 0.0),  # a boat that is to stop gets no kick,
        (-0.3, 0.4, 0.0, -0.3),  # nor one that brakes,
        (0.1, 0.4, -0.2, 0.1),  # nor one that still goes astern
        (0.1, 0.0, 0.0, 0.1),  # nothing to steer
    ],
)
def test_below_steerage_way_the_throttle_kicks_ahead(
    surge: float, yaw: float, water_m_s: float, throttle: float
) -> None:
    assert allocate(Effort(surge, yaw, water_m_s), config()).left == pytest.approx(throttle)


@pytest.mark.parametrize(
    ("water_m_s", "surge", "pair_yaw", "rudder"),
    [
        (0.0, 0.0, 0.4, 0.0),  # at rest the motors turn the boat
        (1.0, 0.5, 0.0, 0.4),  # at cruise the rudder does
        (0.5, 0.25, 0.3, 0.4),  # in between each takes its share: e = 0.25
        (2.0, 1.0, 0.0, 0.1),
    ],
)
def test_two_motors_and_a_rudder_share_the_moment(
    water_m_s: float, surge: float, pair_yaw: float, rudder: float
) -> None:
    thrust = allocate(Effort(surge, 0.4, water_m_s), config("differential_rudder"))
    assert 0.5 * (thrust.left - thrust.right) == pytest.approx(pair_yaw)
    assert thrust.rudder == pytest.approx(rudder)


@given(st.floats(0.0, 1.0), SHARES, st.floats(0.0, 3.0))
def test_the_shares_add_up_to_the_whole(surge: float, yaw: float, water_m_s: float) -> None:
    setting = config("differential_rudder")
    thrust = allocate(Effort(surge, yaw, water_m_s), setting)
    effect = effect_of(setting, surge, water_m_s)
    if effect >= 0.05:
        assert 0.5 * (thrust.left - thrust.right) + effect * thrust.rudder == pytest.approx(yaw, abs=1e-9)


@pytest.mark.parametrize(
    ("layout", "expected"),
    [
        ("differential", Thrust(0.1, -0.9, 0.0)),
        ("rudder", Thrust(-0.4, -0.4, 0.5)),
        ("differential_rudder", Thrust(0.1, -0.9, 0.5)),
    ],
)
def test_the_rudder_follows_the_stick_ahead_and_astern(layout: str, expected: Thrust) -> None:
    thrust = by_hand(-0.4, 0.5, config(layout))
    assert (thrust.left, thrust.right, thrust.rudder) == pytest.approx(
        (expected.left, expected.right, expected.rudder)
    )


@pytest.mark.parametrize("layout", ["rudder", "differential_rudder"])
@pytest.mark.parametrize(
    "effort", [Effort(math.nan, 0.1, 1.0), Effort(0.1, math.nan, 1.0), Effort(0.1, 0.1, math.nan)]
)
def test_nan_reaches_the_gate(layout: str, effort: Effort) -> None:
    thrust = allocate(effort, config(layout))
    assert math.isnan(thrust.left + thrust.right + thrust.rudder)
