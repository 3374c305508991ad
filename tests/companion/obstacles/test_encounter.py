"""The terms that an evasive maneuver is chosen by, in closed form."""

import math

import pytest
from encounter_rig import CONFIG, NOW_S, boat, mover, scene_of
from msgspec.structs import replace

from companion.core.geo import Point
from companion.obstacles.perception.track import Track
from companion.obstacles.planning import moving_obstacles
from companion.obstacles.planning.moving_obstacles import clearance_m

HERE = Point(7.0, -5.0)


@pytest.mark.parametrize(
    ("speed_m_s", "turn", "astern_m", "expected"),
    [
        (1.0, 0.0, 1.7, [(1.0, 0.0), (0.5, 0.3), (1.2, 0.8), (0.0, 0.6), (-0.4, 3.0)]),
        (1.0, 0.0, 1.5, [(1.0, 0.0), (0.5, 0.3), (1.2, 0.8), (0.0, 0.6)]),  # hull room 0.9 m
        (1.0, 0.35, 1.7, [(1.0, 0.0), (0.5, 0.3), (1.2, 0.8)]),
        (0.7, 0.35, 1.7, [(0.7, 0.0), (1.2, 0.8)]),
        (1.15, 0.35, 1.7, [(1.15, 0.0), (0.575, 0.3)]),
        (1.05, 0.35, 1.7, [(1.05, 0.0), (0.525, 0.3), (1.2, 0.8)]),
        (1.8, 0.35, 1.7, [(1.8, 0.0), (0.9, 0.3)]),
    ],
)
def test_the_speeds_that_are_tried(
    speed_m_s: float, turn: float, astern_m: float, expected: list[tuple[float, float]]
) -> None:
    scene = scene_of(solid=(Point(-astern_m, 0.0),))
    found = moving_obstacles._speeds(scene, speed_m_s, turn)
    assert [item for pair in found for item in pair] == pytest.approx([x for pair in expected for x in pair])


@pytest.mark.parametrize(
    ("velocity", "course_rad", "side"),
    [
        ((0.0, 0.5), 0.0, 1),
        ((0.0, -0.5), 0.0, -1),
        ((0.5, 0.34), 0.0, 0),  # across 0.34 of 0.60 m/s
        ((0.5, 0.41), 0.0, 1),  # 0.41 of 0.65
        ((-0.5, 0.0), 0.5 * math.pi, 1),
        ((0.5, 0.0), 0.5 * math.pi, -1),
        ((-0.5, 0.0), 0.0, 0),
        ((0.0, 0.04), 0.0, 0),  # still: its direction is noise
        ((0.0, 0.06), 0.0, 1),
    ],
)
def test_the_side_that_the_nearest_mover_crosses_to(
    velocity: tuple[float, float], course_rad: float, side: int
) -> None:
    near, far = mover(10.0, -5.0, *velocity), mover(12.0, -5.0, 0.0, -0.5 if side >= 0 else 0.5)
    assert moving_obstacles._crossing(scene_of(far, near, nav=boat(at=HERE)), course_rad) == side
    assert moving_obstacles._crossing(scene_of(), course_rad) == 0


@pytest.mark.parametrize("heading_rad", [0.0, 1.0, 3.0, -2.5])
@pytest.mark.parametrize(
    ("off_bow_rad", "distance_m", "is_alongside"),
    [(1.57, 1.38, True), (1.57, 1.43, False), (1.95, 1.3, True), (2.05, 1.3, False), (0.0, 1.3, True)],
)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_alongside_is_within_the_clearance_and_not_abaft(
    heading_rad: float, off_bow_rad: float, distance_m: float, is_alongside: bool, side: float
) -> None:
    angle = heading_rad + side * off_bow_rad
    at = HERE.north_m + distance_m * math.cos(angle), HERE.east_m + distance_m * math.sin(angle)
    scene = scene_of(mover(*at), nav=boat(0.0, heading_rad, at=HERE))
    assert moving_obstacles._is_alongside(scene) is is_alongside
    both = scene_of(mover(90.0, 0.0), mover(*at), nav=boat(0.0, heading_rad, at=HERE))
    assert moving_obstacles._is_alongside(both) is is_alongside


def test_the_clearance_is_margin_radius_and_a_standard_deviation_up_to_a_margin() -> None:
    track = Track(1, NOW_S, Point(3.0, 0.0), 0.3)  # not observed yet: 10 m
    assert clearance_m(track, scene_of()) == pytest.approx(2.3)
    for axis in ((1.0, 0.0), (0.0, 1.0)):
        track.correct(Point(3.0, 0.0), *axis, 0.25)
    assert clearance_m(track, scene_of()) == pytest.approx(1.3 + 0.25, abs=1e-3)


def test_the_nearest_part_of_the_hull_counts() -> None:
    track, scene = mover(HERE.north_m + 3.0, HERE.east_m + 1.0), scene_of(nav=boat(at=HERE))
    way = [(0.0, 0.0, 1.0, 0.0)]
    now_m, nearest_m = moving_obstacles._closest_m(track, scene, way, 0.0, 0.0)
    assert now_m == pytest.approx(math.hypot(3.0, 1.0) - 0.45, abs=1e-3)
    assert nearest_m == pytest.approx(math.hypot(2.55, 1.0), abs=1e-3)
    # A quarter second at 4 m/s south and 2 m/s east: at 2 m north, 1.5 m east; the boat 0.2 m north, bow east
    _, nearest_m = moving_obstacles._closest_m(track, scene, [(0.2, 0.0, 0.0, 1.0)], -4.0, 2.0)
    assert nearest_m == pytest.approx(math.hypot(1.8, 1.5 - 0.45), abs=1e-3)
    _, abeam_m = moving_obstacles._closest_m(track, scene, [*way, (3.2, 0.0, 1.0, 0.0), *way], 0.0, 0.0)
    assert abeam_m == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("bearing_rad", [0.0, 0.5 * math.pi, 2.0, -2.5])
@pytest.mark.parametrize(("across_m_s", "sigma_m_s"), [(0.5, 0.2), (-0.5, 0.2), (0.1, 0.2), (-0.1, 0.2)])
def test_a_crossing_velocity_is_taken_to_be_slower_by_a_standard_deviation(
    bearing_rad: float, across_m_s: float, sigma_m_s: float
) -> None:
    n, e = math.cos(bearing_rad), math.sin(bearing_rad)
    track = Track(1, NOW_S, Point(HERE.north_m + 3.0 * n, HERE.east_m + 3.0 * e), 0.4)
    track._state[2:] = [-0.6 * n - across_m_s * e, -0.6 * e + across_m_s * n]
    track._covariance[2][2] = track._covariance[3][3] = sigma_m_s**2
    found = moving_obstacles._collision_velocity(track, scene_of(nav=boat(0.0, at=HERE)))
    kept = math.copysign(max(abs(across_m_s) - sigma_m_s, 0.0), across_m_s)
    assert found == pytest.approx((-0.6 * n - kept * e, -0.6 * e + kept * n), abs=1e-9)
    # A boat that moves along at the same crossing velocity sees a constant bearing: nothing to take off
    along = replace(boat(0.0, at=HERE), north_m_s=-across_m_s * e, east_m_s=across_m_s * n)
    same = moving_obstacles._collision_velocity(track, scene_of(nav=along))
    assert same == pytest.approx((track.north_m_s, track.east_m_s), abs=1e-9)


@pytest.mark.parametrize(
    ("north_m", "east_m", "near", "hits"),
    [
        (3.0, 0.0, 1.0, 1.0),
        (3.0, 0.35, 0.75, 0.5),  # of 1.4 m clearance, and 0.4 + 0.3 m for the hulls
        (3.0, -0.35, 0.75, 0.5),
        (3.0, 0.98, 0.3, 0.0),
        (3.0, 1.6, 0.0, 0.0),
        (-1.0, 0.0, 0.0, 0.0),  # astern: it recedes
        (9.0, 0.0, 0.607, 0.214),  # 8 s ahead, the bow 0.55 m before it
    ],
)
def test_how_far_a_mover_comes_within_the_clearance(
    north_m: float, east_m: float, near: float, hits: float
) -> None:
    track = mover(HERE.north_m + north_m, HERE.east_m + east_m)
    found = moving_obstacles._encroachment(scene_of(track, nav=boat(at=HERE)), 0.0, 1.0)
    assert found == pytest.approx((near, hits), abs=0.02)
    far = mover(HERE.north_m + 90.0, HERE.east_m)
    assert moving_obstacles._encroachment(scene_of(track, far, nav=boat(at=HERE)), 0.0, 1.0) == found


# The predicted way: 32 steps of a quarter second

GAIN, LOSS, STOP = 0.15, 0.07, 0.14  # m/s a step, of 0.4 m/s²: 1.5, 0.7 and 1.4 times


@pytest.mark.parametrize(
    ("surge_m_s", "speed_m_s", "step_m_s"),
    [(1.0, 1.0, 0.0), (0.0, 2.0, GAIN), (1.0, 0.4, -LOSS), (1.0, 0.0, -STOP), (0.5, -0.4, -STOP)],
)
@pytest.mark.parametrize("heading_rad", [0.0, 2.0, -1.3])
def test_the_predicted_speed_changes_at_its_rate_on_a_straight_way(
    surge_m_s: float, speed_m_s: float, step_m_s: float, heading_rad: float
) -> None:
    way = moving_obstacles._predicted_track(
        scene_of(nav=boat(surge_m_s, heading_rad)), heading_rad, speed_m_s
    )
    assert len(way) == 32
    ahead_m = 0.0
    for step, pose in enumerate(way, 1):
        reached = surge_m_s + step * step_m_s
        surge = min(reached, speed_m_s) if step_m_s > 0.0 else max(reached, speed_m_s)
        ahead_m += 0.25 * surge
        n, e = math.cos(heading_rad), math.sin(heading_rad)
        assert pose == pytest.approx((ahead_m * n, ahead_m * e, n, e), abs=1e-9)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_predicted_turn_begins_a_step_late_and_lags(side: float) -> None:
    nav = boat(0.0, 0.4)
    way = moving_obstacles._predicted_track(scene_of(nav=nav), 0.4 + side * 3.0, 1.0)
    fastest, kept = CONFIG.handling.turn_rate_rad_s, math.exp(-0.25 / 0.6)
    for step in range(5):
        turned = fastest * 0.25 * (step - kept * (1.0 - kept**step) / (1.0 - kept))
        heading = 0.4 + side * turned
        assert way[step][2:] == pytest.approx((math.cos(heading), math.sin(heading)), abs=1e-9)
    run_m = 0.25 * (0.15 + 0.08 + 0.01)  # 0.15 m/s gained in the first step, then lost at 0.07 m/s a step
    assert 0.9 * run_m < math.hypot(*way[2][:2]) < run_m
    assert way[4][:2] == pytest.approx(way[2][:2], abs=1e-9), "it turns on the spot"
    end = 0.4 + side * 3.0
    assert way[-1][2:] == pytest.approx((math.cos(end), math.sin(end)), abs=0.1)
    assert way[-1][0] * math.cos(end) + way[-1][1] * math.sin(end) > 0.5


def test_a_small_heading_error_turns_the_boat_at_one_and_a_half_times_it() -> None:
    way = moving_obstacles._predicted_track(scene_of(), 0.1, 1.0)
    taken = 1.0 - math.exp(-0.25 / 0.6)
    assert math.atan2(way[0][3], way[0][2]) == pytest.approx(0.0)
    assert math.atan2(way[1][3], way[1][2]) == pytest.approx(0.25 * taken * 1.5 * 0.1)


def test_a_turning_boat_that_stops_loses_its_turn() -> None:
    nav = boat(0.0, yaw_rate_rad_s=0.3)
    way = moving_obstacles._predicted_track(scene_of(nav=nav), 1.0, 0.0)
    kept = math.exp(-0.25 / 0.6)
    assert math.atan2(way[0][3], way[0][2]) == pytest.approx(0.25 * 0.3 * kept)


@pytest.mark.parametrize("heading_rad", [0.0, 0.5 * math.pi, 2.0])
def test_the_current_carries_the_boat_sideways(heading_rad: float) -> None:
    nav = replace(boat(0.0, heading_rad), current_north_m_s=0.3, current_east_m_s=0.2)
    way = moving_obstacles._predicted_track(scene_of(nav=nav), 0.0, 0.0)
    n, e = math.cos(heading_rad), math.sin(heading_rad)
    aside = 0.2 * n - 0.3 * e  # what lies along the bow is in the speed over ground already
    assert way[3][:2] == pytest.approx((-aside * e, aside * n), abs=1e-9), "after one second"


def test_in_a_current_the_predicted_bow_points_up_into_it() -> None:
    nav = replace(boat(1.0), current_east_m_s=0.3)
    way = moving_obstacles._predicted_track(scene_of(nav=nav), 0.0, 1.0)
    assert math.atan2(way[-1][3], way[-1][2]) == pytest.approx(-math.atan2(0.3, 1.0), abs=0.01)
