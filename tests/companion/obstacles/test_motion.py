"""The motion model against the emulated hull, and the fan."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig, with_value
from companion.obstacles.planning.motion import (
    BOW,
    CRASH_STOP,
    FULL_ASTERN,
    STEP_S,
    TURNS,
    CourseFan,
    crash_stop_m,
    roll,
    stop_from_cruise_m,
)

CONFIG = BoatConfig()
RUDDER = with_value(CONFIG, "drive.layout", "rudder")


@pytest.mark.parametrize(
    ("surge", "turn", "speed", "ahead", "right"),
    [
        (1.0, 0.0, 0.0, 2.37, 0.0),
        (2.0, 0.0, 0.0, 5.46, 0.0),
        (1.0, 0.5, 1.0, 4.70, 1.63),
        (1.0, 1.0, 1.0, 3.85, 2.62),
        (1.0, 1.57, 1.0, 2.81, 2.95),
        (2.0, 0.5, 2.0, 9.11, 3.30),
        (0.4, 0.7, 1.0, 3.35, 2.02),
        (0.0, 0.0, 1.0, 4.02, 0.0),
        (1.0, 0.0, 0.4, 3.01, 0.0),
    ],
)
def test_after_five_seconds_the_boat_is_where_the_emulated_hull_is(
    surge: float, turn: float, speed: float, ahead: float, right: float
) -> None:
    """Figures of the lake boat with its own control loops in still water, 22 November 2026."""
    found = roll(surge, 0.0, turn, speed, CONFIG)
    centre = (
        found.ahead_m[-1] - BOW * math.cos(found.bow_rad),
        found.right_m[-1] - BOW * math.sin(found.bow_rad),
    )
    assert math.dist(centre, (ahead, right)) < 0.12 * surge + 0.5
    assert found.bow_rad == pytest.approx(turn, abs=0.1)


def test_port_is_starboard_in_the_mirror() -> None:
    right, left = roll(1.0, 0.2, 0.6, 1.0, CONFIG), roll(1.0, -0.2, -0.6, 1.0, CONFIG)
    assert right.ahead_m == pytest.approx(left.ahead_m)
    assert right.right_m == pytest.approx([-side for side in left.right_m])


def test_a_turn_leaves_no_thrust_for_braking() -> None:
    straight, turning = roll(1.5, 0.0, 0.0, 0.0, CONFIG), roll(1.5, 0.0, 1.0, 0.0, CONFIG)
    way = [math.hypot(*at) for at in zip(turning.ahead_m, turning.right_m, strict=True)]
    assert way[7] > straight.ahead_m[7] + 0.05


def test_a_crash_stop_is_shorter_and_ends_at_rest() -> None:
    gentle, crash = roll(1.5, 0.0, 0.0, 0.0, CONFIG), roll(1.5, 0.0, 0.0, CRASH_STOP, CONFIG)
    assert crash.ahead_m[-1] < 0.8 * gentle.ahead_m[-1]
    assert crash.ahead_m[-1] == pytest.approx(max(crash.ahead_m), abs=0.06)


@pytest.mark.parametrize(
    ("speed_m_s", "stops_m"), [(1.0, 1.18), (1.2, 1.58), (1.4, 1.97), (1.6, 2.40), (1.8, 2.86), (2.0, 3.30)]
)
def test_from_its_way_from_cruise_the_boat_knows_the_crash_stop_from_any_speed(
    speed_m_s: float, stops_m: float
) -> None:
    """Figures of the emulated lake boat in still water, 28 November 2026, from the decision to rest."""
    measured = with_value(with_value(CONFIG, "speed.cruise_throttle", 0.61), "handling.stop_m", 3.3)
    assert crash_stop_m(speed_m_s, 0.0, measured) == pytest.approx(stops_m, rel=0.08)
    assert crash_stop_m(speed_m_s, 0.0, CONFIG) > 1.1 * stops_m


@pytest.mark.parametrize(("speed_m_s", "stops_m"), [(0.85, 1.84), (1.1, 2.67), (1.26, 3.28)])
def test_a_boat_of_weak_motors_knows_that_it_needs_longer(speed_m_s: float, stops_m: float) -> None:
    """The kit boat, likewise."""
    kit = CONFIG
    for key, value in (
        ("speed.cruise_m_s", 1.2), ("speed.cruise_throttle", 0.55), ("handling.top_speed_m_s", 1.6),
        ("guidance.accel_m_s2", 0.2), ("handling.stop_m", 3.05),
    ):  # fmt: skip
        kit = with_value(kit, key, value)
    assert crash_stop_m(speed_m_s, 0.0, kit) == pytest.approx(stops_m, rel=0.08)


@pytest.mark.parametrize("stop_m", [0.01, 0.63, 3.3, 50.0])
def test_any_measured_stop_makes_a_model_in_which_a_faster_boat_needs_longer(stop_m: float) -> None:
    measured = with_value(CONFIG, "handling.stop_m", stop_m)
    ways_m = [crash_stop_m(0.1 * tenth, 0.0, measured) for tenth in range(31)]
    assert ways_m == sorted(ways_m)
    assert all(math.isfinite(way_m) for way_m in ways_m)


def test_propellers_kept_full_astern_stop_the_boat_alike_and_take_it_back() -> None:
    crash, back = roll(1.0, 0.0, 0.0, CRASH_STOP, CONFIG), roll(1.0, 0.0, 0.0, FULL_ASTERN, CONFIG)
    assert back.ahead_m[4] == pytest.approx(crash.ahead_m[4])
    assert back.ahead_m[-1] < crash.ahead_m[-1] - 1.5


def test_a_rudder_boat_needs_its_circle() -> None:
    found = roll(1.0, 0.0, math.pi / 2, 1.0, RUDDER)
    pair = roll(1.0, 0.0, math.pi / 2, 1.0, CONFIG)
    assert found.bow_rad < pair.bow_rad
    assert found.ahead_m[-1] > pair.ahead_m[-1] + 0.3
    assert roll(0.0, 0.0, 1.0, 0.0, RUDDER).bow_rad == pytest.approx(0.0, abs=0.05)


def test_a_rudder_boat_has_one_way_to_stop_and_three_astern() -> None:
    fan = CourseFan()
    assert len(fan.rollouts(0.4, 0.0, 0.0, RUDDER)) == 1
    assert sorted(one.turn_rad for one in fan.rollouts(0.4, 0.0, -0.4, RUDDER)) == pytest.approx(
        [-math.radians(30.0), 0.0, math.radians(30.0)]
    )
    assert len(fan.rollouts(0.4, 0.0, 0.0, CONFIG)) == len(TURNS)


@given(
    st.floats(0.05, 20.0), st.floats(0.01, 20.0), st.floats(-30.0, 30.0),
    st.sampled_from((0.0, 0.5, 3.0, -1.0, CRASH_STOP, FULL_ASTERN)),
)  # fmt: skip
def test_every_rollout_is_finite_and_drag_never_turns_the_boat_around(
    top_m_s: float, accel_m_s2: float, surge_m_s: float, speed_m_s: float
) -> None:
    config = with_value(BoatConfig(), "handling.top_speed_m_s", top_m_s)
    config = with_value(config, "guidance.accel_m_s2", accel_m_s2)
    rollout = roll(surge_m_s, 0.0, 0.0, speed_m_s, config)
    fastest_m_s = max(abs(surge_m_s), STEP_S * accel_m_s2 + top_m_s)
    assert all(abs(ahead_m) <= 5.0 * fastest_m_s + BOW for ahead_m in rollout.ahead_m)


def test_boats_with_the_same_figures_share_their_rollouts_and_others_do_not() -> None:
    one, other = CourseFan(), CourseFan()
    same = with_value(RUDDER, "drive.layout", "differential")
    fan = one.rollouts(1.0, 0.0, 1.0, CONFIG)
    assert other.rollouts(1.0, 0.0, 1.0, same) is fan
    assert other.rollouts(1.0, 0.0, 1.0, with_value(CONFIG, "handling.slip_m", 0.9)) != fan
    assert one.rollouts(1.0, 0.0, 1.0, CONFIG) is fan


@pytest.mark.parametrize("stop_m", [2.5, 3.3, 8.0])
@pytest.mark.parametrize("speed_m_s", [0.8, 1.4, 2.6])
def test_a_stop_from_any_speed_tells_the_stop_from_cruise(stop_m: float, speed_m_s: float) -> None:
    config = with_value(CONFIG, "handling.stop_m", stop_m)
    assert stop_from_cruise_m(speed_m_s, crash_stop_m(speed_m_s, 0.0, config), config) == pytest.approx(
        stop_m
    )


def test_a_quarter_of_a_stop_is_braked_however_late_the_motors_reverse() -> None:
    shortest, short = (
        crash_stop_m(CONFIG.speed.cruise_m_s, 0.0, with_value(CONFIG, "handling.stop_m", stop_m))
        for stop_m in (0.2, 0.6)
    )
    assert short - shortest == pytest.approx(0.25 * (0.6 - 0.2))
