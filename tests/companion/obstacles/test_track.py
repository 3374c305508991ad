"""One track: its filter against the Kalman formulas in matrices, and its verdicts one condition at a time."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import Point
from companion.obstacles.perception.track import Track

ORIGIN = Point(0.0, 0.0)
Beam = tuple[float, float, float, float, float]
BEAMS = st.lists(
    st.tuples(
        st.floats(0.05, 0.5),
        st.floats(-3.0, 3.0),
        st.floats(-5.0, 5.0),
        st.floats(-5.0, 5.0),
        st.floats(0.05, 1.0),
    ),
    min_size=1,
    max_size=6,
)


def filtered(looks: list[Beam]) -> tuple[Track, np.ndarray, np.ndarray]:
    """A track, and the same by textbook: x = F x, P = F P Fᵀ + Q; K = P Hᵀ / (H P Hᵀ + R)."""
    track = Track(1, 0.0, Point(10.0, -4.0), 0.3)
    x, p = np.array([10.0, -4.0, 0.0, 0.0]), np.diag([100.0, 100.0, 0.25, 0.25])
    now_s = 0.0
    for dt, bearing, north_m, east_m, sigma_m in looks:
        now_s += dt
        track.predict(now_s, 0.3)
        f = np.eye(4)
        f[0, 2] = f[1, 3] = dt
        g = np.array([[0.5 * dt * dt, 0.0], [0.0, 0.5 * dt * dt], [dt, 0.0], [0.0, dt]])
        x, p = f @ x, f @ p @ f.T + 0.09 * g @ g.T
        beam = math.cos(bearing), math.sin(bearing)
        at = Point(10.0 + north_m, -4.0 + east_m)
        h = np.array([beam[0], beam[1], 0.0, 0.0])
        variance = h @ p @ h + sigma_m**2
        off = h @ (np.array([*at, 0.0, 0.0]) - x)
        assert track.deviation_sigmas(at, *beam, sigma_m) == pytest.approx(
            abs(off) / math.sqrt(variance), rel=1e-6
        )
        track.correct(at, *beam, sigma_m)
        gain = p @ h / variance
        x, p = x + gain * off, p - np.outer(gain, h @ p)
    track.is_mover = True
    return track, x, p


@given(BEAMS)
def test_the_filter_is_the_textbooks(looks: list[Beam]) -> None:
    track, x, p = filtered(looks)
    now_s = sum(look[0] for look in looks)
    assert track.point(now_s) == pytest.approx((x[0], x[1]), abs=1e-6)
    assert (track.north_m_s, track.east_m_s) == pytest.approx((x[2], x[3]), abs=1e-6)
    assert track.speed_m_s == pytest.approx(math.hypot(x[2], x[3]), abs=1e-6)
    ahead = np.array([math.cos(0.7), math.sin(0.7)])
    assert track.pace_sigma_m_s(*ahead) == pytest.approx(math.sqrt(ahead @ p[2:, 2:] @ ahead), rel=1e-5)
    if track.speed_m_s > 1e-3:
        along = np.array([x[2], x[3]]) / math.hypot(x[2], x[3])
        assert track.speed_sigma_m_s == pytest.approx(math.sqrt(along @ p[2:, 2:] @ along), rel=1e-4)
    f = np.eye(4)
    f[0, 2] = f[1, 3] = 1.5
    later = f @ p @ f.T
    ahead_m2, past_m2 = track.covariance(now_s + 1.5), track.covariance(now_s - 1.0)
    assert ahead_m2 == pytest.approx((later[0, 0], later[0, 1], later[1, 1]), rel=1e-6, abs=1e-9)
    assert past_m2 == pytest.approx((p[0, 0], p[0, 1], p[1, 1]), rel=1e-6, abs=1e-9)
    prior, rest = 0.25, np.array([x[2], x[3]])
    size = np.linalg.det(p[2:, 2:])
    ratio = prior / math.sqrt(size) * math.exp(-0.5 * rest @ np.linalg.inv(p[2:, 2:]) @ rest)
    assert track.rest_ratio() == pytest.approx(ratio, rel=1e-4, abs=1e-9)
    assert track.point(now_s + 2.0) == pytest.approx((x[0] + 2.0 * x[2], x[1] + 2.0 * x[3]), abs=1e-5)


def moving(
    north_m_s: float,
    east_m_s: float,
    *,
    looks: int = 5,
    start: Point = ORIGIN,
    is_alone: bool = True,
    beam_rad: float = 0.0,
) -> Track:
    """Observed exactly every 0.3 s."""
    track = Track(1, 0.0, start, 0.3)
    for axis in ((1.0, 0.0), (0.0, 1.0)):
        track.correct(start, *axis, 0.02)
    for look in range(1, looks):
        now_s = 0.3 * look
        track.predict(now_s, 0.1)
        at = Point(start.north_m + north_m_s * now_s, start.east_m + east_m_s * now_s)
        for axis in ((1.0, 0.0), (0.0, 1.0)):
            track.correct(at, *axis, 0.02)
        track.complete_observation(0.3, math.cos(beam_rad), math.sin(beam_rad), is_alone=is_alone)
    return track


def test_the_speed_of_what_moves_is_found() -> None:
    track = moving(0.6, -0.8)
    assert (track.north_m_s, track.east_m_s) == pytest.approx((0.6, -0.8), abs=0.05)
    track.is_mover = True
    assert track.point(2.2) == pytest.approx((0.6 * 2.2, -0.8 * 2.2), abs=0.1)
    track.is_mover = False
    assert track.point(2.2) == pytest.approx((0.6 * 1.2, -0.8 * 1.2), abs=0.1), "where it was seen last"


def test_distance_and_closing_are_those_of_the_two_velocities() -> None:
    track = moving(-1.0, 0.0, start=Point(20.0, 0.0))  # at 18.8 m north after 1.2 s
    track.is_mover = True
    boat = Point(8.8, 0.0)
    assert track.distance_m(boat, 1.2) == pytest.approx(10.0, abs=0.1)
    assert track.distance_m(Point(18.8, 7.0), 1.2) == pytest.approx(7.0, abs=0.1)
    assert track.closing_m_s(boat, 0.0, 0.0, 1.2) == pytest.approx(1.0, abs=0.05)
    assert track.closing_m_s(boat, 2.0, 5.0, 1.2) == pytest.approx(3.0, abs=0.1)
    assert track.closing_m_s(Point(28.8, 0.0), 0.0, 0.0, 1.2) == pytest.approx(-1.0, abs=0.05)
    east = moving(0.0, -1.0, start=Point(0.0, 20.0))
    assert east.closing_m_s(Point(0.0, 9.0), 0.0, 0.5, 1.2) == pytest.approx(1.5, abs=0.1)
    diagonal = moving(0.0, 0.0, start=Point(3.0, 4.0))
    assert diagonal.closing_m_s(Point(0.0, 0.0), 1.0, 1.0, 1.2) == pytest.approx(1.4, abs=0.05)


def test_an_observation_counts_and_its_size_shrinks_slowly() -> None:
    track = Track(1, 0.0, Point(0.0, 0.0), 1.0)
    track.predict(0.5, 0.1)
    track.complete_observation(0.1, 1.0, 0.0)
    assert (track.observations, track.isolated_count, track.seen_s) == (2, 1, 0.5)
    assert track.radius_m == pytest.approx(0.8)
    track.complete_observation(2.0, 1.0, 0.0, is_alone=False)
    assert (track.observations, track.isolated_count, track.radius_m) == (3, 1, 2.0)


# Verdicts. The least speed that counts is 0.2 m/s


def judged(track: Track) -> Track:
    track.classify(0.2)
    return track


@pytest.mark.parametrize("beam_rad", [0.0, 0.8, 0.5 * math.pi, -2.0])
@pytest.mark.parametrize(
    ("off_rad", "speed_m_s", "is_mover"),
    [
        (math.pi, 1.0, True),
        (math.pi - 0.8, 1.0, True),
        (math.pi, 0.1, False),
        (0.0, 1.0, False),
        (1.5, 1.0, False),
    ],
)
def test_what_approaches_along_the_beam_moves(
    beam_rad: float, off_rad: float, speed_m_s: float, is_mover: bool
) -> None:
    course = beam_rad + off_rad
    track = moving(speed_m_s * math.cos(course), speed_m_s * math.sin(course), beam_rad=beam_rad)
    assert judged(track).is_mover is is_mover


def test_what_is_too_fast_to_be_one_thing_is_no_mover() -> None:
    assert judged(moving(-2.3, 0.0)).is_mover
    assert not judged(moving(-2.5, 0.0)).is_mover


def test_a_mover_stays_one_until_it_is_nearly_at_rest() -> None:
    slow = moving(0.15, 0.0, looks=12)
    assert slow.speed_sigma_m_s < 0.1
    assert not judged(slow).is_mover
    slow.is_mover = True
    assert judged(slow).is_mover
    slower = moving(0.05, 0.0, looks=12)
    slower.is_mover = True
    assert not judged(slower).is_mover


def test_a_track_may_move_while_it_is_seen_alone() -> None:
    track = Track(1, 0.0, Point(0.0, 0.0), 0.4)
    assert track.may_move(0.1), "its edges were not seen yet"
    track.observations, track.seen_s = 3, 1.4
    assert not track.may_move(1.6)
    track.whole_count = 1
    assert not track.may_move(1.6)
    track.isolated_count = 1
    assert track.may_move(1.6), "two looks that did not cover it say nothing"
    track.whole_count = 3
    assert not track.may_move(1.6)
    track.isolated_count = 2
    assert track.may_move(1.6)
    assert not track.may_move(3.0)
    track.is_mover = True
    assert track.may_move(3.0)


def test_a_track_that_touches_what_stands_stands_until_it_is_far_from_there() -> None:
    track = Track(1, 0.0, Point(3.0, 0.0), 0.4)
    track.note_standing(Point(3.0, 0.0), [Point(3.0, 0.5)])
    assert not track.stands(0.0, 2.0)
    track.note_standing(Point(3.0, 0.0), [Point(9.0, 9.0), Point(3.0, 0.3)])
    assert track.stands(0.0, 2.0)
    track.is_mover, track._state[2] = True, 0.5  # casts off
    assert track.stands(3.9, 2.0)
    assert not track.stands(4.1, 2.0)
