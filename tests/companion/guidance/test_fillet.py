"""Fillets: what the hull is asked for in a current, worked out from the ground track alone."""

import math
from itertools import pairwise

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig
from companion.core.units import wrap_pi
from companion.guidance.fillet import (
    HASTY_SHARE,
    LEAST_AHEAD_SHARE,
    OUTSIDE_M,
    PASSED_RADII,
    STEPS,
    TURN_SHARE,
    Bend,
    Fillet,
    FilletNode,
    best_fillet,
    cost_s,
    fillet_between,
)

CONFIG = BoatConfig()
SPEED_M_S = 2.0
RADIUS_M = 2.0
RAMP_S = CONFIG.handling.yaw_time_s
angles = st.floats(-math.pi, math.pi)
turns = st.floats(-2.3, 2.3).filter(lambda turn: abs(turn) > 0.02)
currents = st.floats(0.0, 1.0)


def bend(
    turn_rad: float,
    current_m_s: float = 0.0,
    current_to_rad: float = 0.0,
    *,
    course_rad: float = 0.0,
    room_m: float = 25.0,
    onward: tuple[float, float] = (50.0, 0.0),
) -> Bend:
    north, east = current_m_s * math.cos(current_to_rad), current_m_s * math.sin(current_to_rad)
    return Bend(course_rad, turn_rad, room_m, room_m, RADIUS_M, SPEED_M_S, north, east, *onward)


def through_water(at: Bend, fillet: Fillet) -> list[tuple[float, float]]:
    """Heading and speed through the water at each node: the velocity over ground less the current."""
    found = []
    for node in fillet.nodes:
        course = at.course_rad + node.turned_rad
        north = node.speed_m_s * math.cos(course) - at.current_north_m_s
        east = node.speed_m_s * math.sin(course) - at.current_east_m_s
        found.append((math.atan2(east, north), math.hypot(north, east)))
    return found


@given(turns, currents, angles, angles)
def test_the_hull_is_asked_for_no_more_than_it_has(
    turn: float, current_m_s: float, current_to: float, course: float
) -> None:
    at = bend(turn, current_m_s, current_to, course_rad=course)
    fillet = best_fillet(at, CONFIG)
    assume(fillet is not None)
    assert fillet is not None
    step_s = fillet.time_s / STEPS
    water = through_water(at, fillet)
    least = LEAST_AHEAD_SHARE * CONFIG.guidance.min_speed_m_s
    for (bow, speed), along in ((water[0], course), (water[-1], course + turn)):
        assert speed * math.cos(bow - along) >= least - 1e-9, "the bow points ahead along both legs"
    for (bow, speed), (next_bow, next_speed) in pairwise(water):
        rate = abs(wrap_pi(next_bow - bow)) / step_s
        assert rate <= TURN_SHARE * CONFIG.handling.turn_rate_rad_s * 1.001
        assert rate * 0.5 * (speed + next_speed) <= CONFIG.guidance.corner_accel_m_s2 * 1.001
        assert abs(next_speed - speed) / step_s <= CONFIG.guidance.accel_m_s2 * 1.001
        assert speed <= CONFIG.handling.top_speed_m_s


@given(turns, currents, angles)
def test_it_leads_from_leg_to_leg_inside_of_the_corner_and_past_the_waypoint(
    turn: float, current_m_s: float, current_to: float
) -> None:
    fillet = best_fillet(bend(turn, current_m_s, current_to), CONFIG)
    assume(fillet is not None)
    assert fillet is not None
    first, last = fillet.nodes[0], fillet.nodes[-1]
    assert (first.north_m, first.east_m) == pytest.approx((-fillet.entry_m, 0.0), abs=1e-9)
    joins = (fillet.exit_m * math.cos(turn), fillet.exit_m * math.sin(turn))
    assert (last.north_m, last.east_m) == pytest.approx(joins, abs=1e-6)
    assert first.turned_rad == pytest.approx(0.0, abs=1e-9)
    assert wrap_pi(last.turned_rad - turn) == pytest.approx(0.0, abs=1e-6)
    side = math.copysign(1.0, turn)
    for node in fillet.nodes:
        assert side * node.east_m >= -OUTSIDE_M
        assert side * (node.east_m * math.cos(turn) - node.north_m * math.sin(turn)) >= -OUTSIDE_M
    nearest = min(math.hypot(node.north_m, node.east_m) for node in fillet.nodes)
    assert fillet.cut_m == pytest.approx(nearest)
    assert nearest <= (2.0 * RADIUS_M if current_m_s > 0.25 and abs(turn) <= 2.0 else RADIUS_M)


@given(st.floats(0.05, 2.3), currents, st.floats(0.01, 3.1))
def test_a_corner_to_port_is_sailed_like_its_mirror_image(
    turn: float, current_m_s: float, current_to: float
) -> None:
    one = best_fillet(bend(turn, current_m_s, current_to), CONFIG)
    other = best_fillet(bend(-turn, current_m_s, -current_to), CONFIG)
    assert (one is None) == (other is None)
    if one is not None and other is not None:
        assert other.time_s == pytest.approx(one.time_s)
        assert other.nodes[5].east_m == pytest.approx(-one.nodes[5].east_m)


@given(turns, st.floats(0.3, 30.0), st.floats(0.3, 30.0))
def test_it_takes_no_more_of_either_leg_than_it_may(turn: float, entry_m: float, exit_m: float) -> None:
    fillet = best_fillet(bend(turn)._replace(entry_room_m=entry_m, exit_room_m=exit_m), CONFIG)
    assume(fillet is not None)
    assert fillet is not None
    assert 0.0 <= fillet.entry_m <= entry_m
    assert 0.0 <= fillet.exit_m <= exit_m


def test_the_boat_can_lose_its_speed_before_the_way_onward_asks_for_it() -> None:
    fillet = best_fillet(bend(1.0, onward=(4.0, 0.3)), CONFIG)
    assert fillet is not None
    left = fillet.nodes[-1].speed_m_s
    room_m = 4.0 - fillet.exit_m
    assert left**2 <= 0.3**2 + 2.0 * CONFIG.guidance.accel_m_s2 * room_m + 1e-9
    free = best_fillet(bend(1.0), CONFIG)
    assert free is not None
    assert free.nodes[-1].speed_m_s > left


def test_where_legs_are_too_short_for_ramps_the_rate_changes_ten_times_as_fast() -> None:
    short = bend(math.radians(6.0), room_m=0.5)
    fillet = best_fillet(short, CONFIG)
    assert fillet is not None
    assert fillet.nodes[0].speed_m_s == SPEED_M_S
    assert fillet_between(short, 2.0, 2.0, RAMP_S, CONFIG) is None
    assert fillet == fillet_between(short, 2.0, 2.0, HASTY_SHARE * RAMP_S, CONFIG)
    rate = CONFIG.guidance.corner_accel_m_s2 / SPEED_M_S
    growth = 10.0 * TURN_SHARE * CONFIG.handling.turn_rate_rad_s / RAMP_S
    assert fillet.time_s == pytest.approx(math.radians(6.0) / rate + rate / growth)


@pytest.mark.parametrize("turn", [0.0, 0.005, 2.5, -3.1, math.pi])
def test_no_turn_and_a_turn_back_have_no_fillet(turn: float) -> None:
    assert best_fillet(bend(turn), CONFIG) is None


@pytest.mark.parametrize(("radius_m", "expected"), [(2.0, 17.0 * 0.5 + 20.0), (4.0, 17.0 * 0.125)])
def test_the_cost_is_the_time_lost_and_the_price_of_the_error(radius_m: float, expected: float) -> None:
    # 5 s for 7 m; from 1.5 and 1 m/s to 2 m/s at 0.4 m/s²; 2 m² s off the legs; 3 m from the waypoint
    nodes = (FilletNode(-3.0, 0.0, 0.0, 1.5), FilletNode(0.0, 0.0, 0.5, 9.0), FilletNode(0.0, 4.0, 1.0, 1.0))
    at = bend(1.0)._replace(radius_m=radius_m)
    lost = 5.0 - 3.5 + 0.25 / 1.6 + 1.0 / 1.6  # halfway to the full speed, at half the top speed, 0.4 m/s²
    found = cost_s(Fillet(3.0, 4.0, 5.0, 3.0, 2.0, nodes), at, CONFIG)
    assert found == pytest.approx(lost + expected)


@pytest.mark.parametrize(
    ("turn", "current_m_s", "current_to_deg"),
    [(1.9, 1.0, 45.0), (2.1, 0.5, 45.0), (2.3, 0.5, 90.0)],
    ids=["2.2 radii", "sharp, 1.5 radii", "sharp, 2 radii"],
)
def test_a_corner_that_the_current_sweeps_too_far_off_is_turned_on_the_spot(
    turn: float, current_m_s: float, current_to_deg: float
) -> None:
    assert best_fillet(bend(turn, current_m_s, math.radians(current_to_deg)), CONFIG) is None


@pytest.mark.parametrize(
    ("radius_m", "current_m_s", "is_filleted"), [(0.1, 0.1, False), (0.1, 0.2, True), (2.0, 2.0, True)]
)
def test_a_fillet_is_sailed_where_a_boat_on_the_spot_would_drift_farther_than_it_cuts(
    radius_m: float, current_m_s: float, is_filleted: bool
) -> None:
    following = bend(0.5 * math.pi, current_m_s, 0.25 * math.pi)._replace(radius_m=radius_m)
    fillet = best_fillet(following, CONFIG)
    assert (fillet is not None) == is_filleted
    if fillet is not None:
        turning_s = 0.5 * math.pi / (TURN_SHARE * CONFIG.handling.turn_rate_rad_s) + RAMP_S
        assert PASSED_RADII * radius_m < fillet.cut_m < current_m_s * turning_s
