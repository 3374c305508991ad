"""The risk of a collision with vessels that have AIS, and what the planner makes of it."""

import math

import pytest
from avoidance_rig import NORTH, ROCK, Voyage, boat, mover
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from companion.core.geo import Point
from companion.core.intent import Drive, FollowLeg, HoldHeading, KeepStation
from companion.obstacles.perception.vessels import LOOK_AHEAD_S, Vessel
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.motion import STEP_S
from companion.obstacles.planning.movers import VESSEL_S, collision_risk, predict_vessels
from companion.obstacles.planning.planner import GIVING_WAY, KEEPING_CLEAR, Stage

FIELD = ClearanceField(Point(0.0, 0.0), 0.2, 10.0)


def vessel(
    north_m: float,
    east_m: float,
    north_m_s: float = 0.0,
    east_m_s: float = 0.0,
    half_m: tuple[float, float] = (3.0, 3.0),
    heading_rad: float = 0.0,
    sigma_m: float = 0.5,
    sigma_m_s: float = 0.0,
) -> Vessel:
    at = Point(north_m, east_m)
    return Vessel("SHIP", at, north_m_s, east_m_s, heading_rad, *half_m, sigma_m, sigma_m_s, 0.0)


def risk(
    one: Vessel,
    north_m_s: float = 1.0,
    east_m_s: float = 0.0,
    margin_m: float = 0.0,
    own_sigma_m: float = boat().position_sigma_m,
) -> float:
    """Of a boat that sails on from the origin."""
    nav = replace(boat(), position_sigma_m=own_sigma_m)
    found = predict_vessels([one], nav, (north_m_s, east_m_s), FIELD, margin_m)
    norths = [(north_m_s * time_s - FIELD.south_m) / FIELD.cell_m for time_s in VESSEL_S]
    easts = [(east_m_s * time_s - FIELD.west_m) / FIELD.cell_m for time_s in VESSEL_S]
    return collision_risk(found[0], norths, easts)


def sampled(one: Vessel, north_m_s: float, margin_m: float, own_sigma_m: float) -> float:
    """The same integral of P over the beam by small steps, from the formulas of `movers.py`."""
    a, b = (half + margin_m for half in (one.half_length_m, one.half_beam_m))
    closing = north_m_s - one.north_m_s, -one.east_m_s
    square = closing[0] ** 2 + closing[1] ** 2
    closest_s = (one.at.north_m * closing[0] + one.at.east_m * closing[1]) / square
    noise_m2 = one.variance_m2(min(max(closest_s, 0.0), LOOK_AHEAD_S)) + own_sigma_m**2
    s_a, s_b = 0.25 * a * a + noise_m2, 0.25 * b * b + noise_m2
    total, dt_s = 0.0, 0.01
    for step in range(round((LOOK_AHEAD_S - STEP_S) / dt_s)):
        time_s = STEP_S + (step + 0.5) * dt_s
        north = north_m_s * time_s - one.at.north_m - one.north_m_s * time_s
        east = -one.at.east_m - one.east_m_s * time_s
        c, s = math.cos(one.heading_rad), math.sin(one.heading_rad)
        along, across = north * c + east * s, east * c - north * s
        peak = 0.5 * a * b / math.sqrt(s_a * s_b)
        p = peak * math.exp(-0.5 * (along * along / s_a + across * across / s_b))
        total += p * math.sqrt(square) * dt_s / (2.0 * b)
    return total


@pytest.mark.parametrize(
    "one",
    [
        vessel(30.0, -100.0, 0.0, 4.0, half_m=(20.0, 4.0), heading_rad=1.2, sigma_m=4.0, sigma_m_s=0.2),
        vessel(120.0, 0.0, -4.0, 0.1, half_m=(10.0, 3.0), heading_rad=3.0, sigma_m=4.0),
        vessel(40.0, 6.0, half_m=(8.0, 2.0), heading_rad=0.7, sigma_m=2.0),
    ],
)
@pytest.mark.parametrize("margin_m", [0.0, 5.0])
def test_the_sum_is_the_integral_weighted_by_a_half_behind_the_rollout(one: Vessel, margin_m: float) -> None:
    expected = sampled(one, 1.0, margin_m, 3.0)
    assert expected > 0.05
    assert risk(one, margin_m=margin_m, own_sigma_m=3.0) == pytest.approx(0.5 * expected, rel=0.1)


def test_what_is_met_within_the_rollout_counts_more_the_sooner() -> None:
    soon, late = (risk(vessel(north_m, -4.0 * north_m, 0.0, 4.0, sigma_m=4.0)) for north_m in (3.0, 10.0))
    assert soon == pytest.approx(1.4 * late, rel=0.15)


def test_a_ship_is_longer_than_wide() -> None:
    ahead = {"half_m": (20.0, 3.0), "sigma_m": 0.5}
    assert risk(vessel(60.0, 10.0, heading_rad=0.5 * math.pi, **ahead)) > 0.1  # type: ignore[arg-type]
    assert risk(vessel(60.0, 10.0, heading_rad=0.0, **ahead)) < 0.01  # type: ignore[arg-type]


def test_a_vessel_that_keeps_its_distance_goes_away_or_is_met_later_is_no_risk() -> None:
    assert risk(vessel(10.0, 0.0, 1.0, 0.0)) == 0.0
    assert risk(vessel(20.0, 0.0, 4.0, 0.0)) == 0.0
    assert risk(vessel(30.0, -20.0 * LOOK_AHEAD_S, 0.0, 10.0)) == 0.0


@given(st.floats(-500.0, 500.0), st.floats(-500.0, 500.0), st.floats(-30.0, 30.0), st.floats(-30.0, 30.0))
def test_a_risk_is_finite_and_bounded(
    north_m: float, east_m: float, north_m_s: float, east_m_s: float
) -> None:
    assert 0.0 <= risk(vessel(north_m, east_m, north_m_s, east_m_s, half_m=(20.0, 4.0))) < 20.0


def sailed(*vessels: Vessel) -> Voyage:
    """In open water, with the vessels; nothing is seen."""
    voyage = Voyage()
    voyage.chart.is_within_sight = False
    voyage.chart.vessels = vessels
    return voyage


def test_a_boat_gives_way_to_a_ship_beyond_its_sight_to_starboard_and_says_so_once() -> None:
    voyage = sailed(vessel(80.0, 0.0, -4.0, 0.0, sigma_m=4.0))
    held = voyage.at(1.0)
    assert isinstance(held, HoldHeading)
    assert 0.1 < held.heading_rad < 1.6
    assert voyage.stage() is Stage.PASSING
    voyage.at(1.2)
    assert voyage.said == [f"{KEEPING_CLEAR} SHIP"]


def test_a_ship_somewhat_to_starboard_is_passed_to_starboard_too() -> None:
    """Rule 14, though to port were the shorter way."""
    held = sailed(vessel(100.0, 3.0, -4.0, 0.0, sigma_m=4.0)).at(1.0)
    assert isinstance(held, HoldHeading)
    assert held.heading_rad > 0.1


def test_before_a_vessel_close_by_the_boat_stops_with_full_thrust_astern() -> None:
    held = sailed(vessel(8.0, -14.0, 0.0, 4.0, sigma_m=1.0)).at(1.0, boat(speed_m_s=2.0))
    assert isinstance(held, Drive)
    assert held.throttle < 0.0


def test_a_vessel_far_off_does_not_change_how_a_new_rock_is_met() -> None:
    decided = []
    for vessels in ((), (vessel(150.0, 80.0, -1.0, 0.0, sigma_m=4.0),)):
        voyage = Voyage(*ROCK)
        voyage.chart.vessels = vessels
        decided.append((voyage.at(1.0), voyage.at(1.3)))
    assert decided[0] == decided[1]


def test_a_ship_that_passes_clear_changes_nothing() -> None:
    voyage = sailed(vessel(80.0, 60.0, -4.0, 0.0, sigma_m=4.0))
    assert voyage.at(1.0) is NORTH
    assert voyage.said == []


def test_a_boat_returns_to_its_leg_once_a_vessel_is_past() -> None:
    leg = FollowLeg(Point(0.0, 0.0), Point(60.0, 0.0), 1.0)
    aside = replace(boat(speed_m_s=1.2), north_m=26.5, east_m=10.6)
    past = vessel(16.5, 0.3, -1.0, 0.0, half_m=(1.0, 1.0), sigma_m=4.9, sigma_m_s=0.14)
    assert sailed(past).at(1.0, aside, leg) is leg


def test_a_boat_on_its_station_moves_out_of_a_ships_way() -> None:
    station = KeepStation(Point(0.0, 0.0))
    voyage = sailed(vessel(0.0, -80.0, 0.0, 4.0, sigma_m=4.0))
    assert isinstance(voyage.at(1.0, boat(speed_m_s=0.0), station), HoldHeading)
    voyage = sailed(vessel(100.0, -80.0, 0.0, 4.0, sigma_m=4.0))
    assert voyage.at(1.0, boat(speed_m_s=0.0), station) is station


def test_a_ship_at_anchor_ahead_is_passed() -> None:
    leg = FollowLeg(Point(0.0, 0.0), Point(150.0, 0.0), 1.0)
    held = sailed(vessel(60.0, 0.0, half_m=(20.0, 4.0), sigma_m=4.0)).at(1.0, intent=leg)
    assert isinstance(held, HoldHeading)
    assert held.speed_m_s > 0.5
    assert held.heading_rad > 0.3


def test_without_rangers_in_use_or_by_hand_vessels_change_nothing() -> None:
    voyage = sailed(vessel(80.0, 0.0, -4.0, 0.0))
    assert voyage.at(1.0, is_by_hand=True) is NORTH


def test_the_same_ship_seen_by_sonar_and_ais_is_avoided_as_by_either() -> None:
    """Its echoes are a mover of their own: the sum of both risks only adds to what is avoided anyway."""
    track, twin = mover(4.0, -3.0, 0.0, 1.2, now_s=1.0), vessel(4.0, -3.0, 0.0, 1.2, half_m=(0.5, 0.5))
    for vessels in ((), (twin,)):
        voyage = sailed(*vessels)
        voyage.chart.is_within_sight = True
        voyage.chart.tracks.all = [track]
        assert voyage.at(1.0) is not NORTH
        assert voyage.said == [GIVING_WAY]


def test_beside_a_moored_vessel_the_boat_is_free_and_ahead_of_it_it_is_not() -> None:
    """The error of the position alone would keep it from leaving."""
    moored = vessel(0.0, 8.0, sigma_m=5.0)
    assert risk(moored) == pytest.approx(0.0, abs=1e-3)
    assert risk(moored, 0.0, 1.0) > 0.1
    assert risk(vessel(0.0, 8.0, -1.2, 0.0, sigma_m=5.0)) > 0.02, "it is under way"
    assert risk(vessel(0.0, 0.0, sigma_m=5.0)) < 0.6, "where no other can be"
