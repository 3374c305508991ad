"""The risk of a collision with what may move."""

import pytest
from avoidance_rig import boat, mover

from companion.core.geo import Point
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.motion import STEP_S, STEPS
from companion.obstacles.planning.movers import collision_risk, moves_probability, predict, worst_velocity

NOW_S = 0.9
NORTH = (1.0, 0.0)


def new(north_m: float, east_m: float) -> Track:
    track = Track(1, NOW_S, Point(north_m, east_m), 0.4)
    for axis in ((1.0, 0.0), (0.0, 1.0)):
        track.correct(Point(north_m, east_m), *axis, 0.1)
    return track


def risk(track: Track, north_m_s: float = 1.0, east_m_s: float = 0.0, clear_m: float = 0.6) -> float:
    """Of a boat that sails on from the origin. clear_m: half its hull."""
    field = ClearanceField(Point(0.0, 0.0), 0.2, 10.0)
    found = predict([track], 0, boat(), NORTH, field, 1.0, clear_m, NOW_S)
    if not found:
        return 0.0
    times = [STEP_S * (step + 1) for step in range(STEPS)]
    norths = [(north_m_s * time_s - field.south_m) / field.cell_m for time_s in times]
    easts = [(east_m_s * time_s - field.west_m) / field.cell_m for time_s in times]
    return collision_risk(found[0], norths, easts)


def test_a_new_echo_moves_with_the_prior_probability() -> None:
    assert moves_probability(new(4.0, 0.0), 0) == pytest.approx(0.5, abs=0.02)


def test_among_still_things_a_new_echo_is_most_likely_still_and_a_known_mover_moves() -> None:
    assert moves_probability(new(4.0, 0.0), 8) == pytest.approx(0.1, abs=0.01)
    assert moves_probability(mover(4.0, 0.0), 8) == 1.0


def test_the_worst_velocity_is_within_two_standard_deviations_and_on_a_collision_course() -> None:
    ahead = new(4.0, 0.0)
    most_m_s = 2.0 * ahead.speed_sigma_m_s
    assert worst_velocity(ahead, boat(), NORTH, NOW_S) == pytest.approx((-most_m_s, 0.0), abs=0.01)
    abeam = worst_velocity(new(0.0, 4.0), boat(), (0.3, 0.0), NOW_S)
    assert abeam == pytest.approx((0.3, -most_m_s), abs=0.01)
    fast = worst_velocity(new(0.0, 4.0), boat(), (2.0, 0.0), NOW_S)
    assert fast == pytest.approx((most_m_s, -most_m_s), abs=0.01)


def test_a_collision_counts_once_and_a_miss_not_at_all() -> None:
    assert 0.5 < risk(mover(4.0, 0.0, -0.3, 0.0)) < 1.5
    assert risk(mover(4.0, 3.5, -0.3, 0.0)) < 0.01
    assert risk(mover(2.5, -2.5, 0.0, 1.0)) > 0.5
    assert risk(mover(2.5, -2.5, 0.0, -1.0)) < 0.01


def test_the_size_of_the_hull_matters_for_what_passes_and_not_for_what_is_met() -> None:
    met, passing = mover(3.0, 0.0, -0.3, 0.0), mover(3.0, 1.2, -0.3, 0.0)
    assert risk(met, clear_m=0.2) == pytest.approx(risk(met, clear_m=1.2), rel=0.5)
    assert risk(passing, clear_m=0.2) < 0.3 * risk(passing, clear_m=1.2)


def test_what_keeps_its_distance_may_still_come_if_its_speed_is_uncertain() -> None:
    """Boat and echo go the same way at the same speed: only the uncertainty brings them together."""
    known, unknown = mover(1.0, 0.0, 1.0, 0.0), mover(1.0, 0.0, 1.0, 0.0)
    unknown._covariance[2][2] = unknown._covariance[3][3] = 0.25
    assert risk(known) < 0.1
    assert risk(unknown) > 5.0 * risk(known)


@pytest.mark.parametrize("here", [Point(0.0, 0.0), Point(30.0, -50.0)])
def test_the_middle_of_a_mover_lies_beyond_its_echo(here: Point) -> None:
    track = mover(here.north_m + 3.0, here.east_m + 4.0)
    field = ClearanceField(here, 0.2, 10.0)
    found = predict([track], 0, boat(*here), NORTH, field, 1.0, 0.6, NOW_S)[0]
    middle = found.north[0] * 0.2 + field.south_m, found.east[0] * 0.2 + field.west_m
    assert middle == pytest.approx((here.north_m + 3.0 + 0.6 * 0.4, here.east_m + 4.0 + 0.8 * 0.4), abs=0.02)


@pytest.mark.parametrize("clear_m", [0.2, 0.8])
def test_the_spread_of_a_known_mover_is_half_its_radius_and_the_boats(clear_m: float) -> None:
    """S = R² / 4; half of its inverse in cells of 0.2 m, and a peak of ½ R² / √|S|."""
    field, radius_m = ClearanceField(Point(0.0, 0.0), 0.2, 10.0), 0.4 + clear_m
    found = predict([mover(4.0, 0.0)], 0, boat(), NORTH, field, 1.0, clear_m, NOW_S)[0]
    expected = 0.5 * 0.2**2 * 4.0 / radius_m**2
    assert (found.north2[0], found.east2[0]) == pytest.approx((expected, expected), rel=0.02)
    assert (found.cross[0], found.peak[0]) == pytest.approx((0.0, 2.0), abs=0.04)
