"""The verdicts on a track know no north, no origin and no beginning of time."""

import math

import pytest

from companion.core.geo import Point
from companion.obstacles.perception.track import Track

START_S, START = 100.0, Point(70.0, -40.0)


def observed(course_rad: float, speed_m_s: float, beam_rad: float, looks: int = 5) -> Track:
    """Every 0.3 s, to two centimetres, isolated."""
    track = Track(1, START_S, START, 0.3)
    for look in range(looks):
        since_s = 0.3 * look
        track.predict(START_S + since_s, 0.1)
        at = Point(
            START.north_m + speed_m_s * since_s * math.cos(course_rad),
            START.east_m + speed_m_s * since_s * math.sin(course_rad),
        )
        for axis in ((1.0, 0.0), (0.0, 1.0)):
            track.correct(at, *axis, 0.02)
        if look:
            track.complete_observation(0.3, math.cos(beam_rad), math.sin(beam_rad))
    return track


def judged(track: Track, after_s: float, *, is_small: bool) -> Track:
    track.classify(0.2, START_S + after_s, is_small=is_small)
    return track


@pytest.mark.parametrize("beam_rad", [0.0, 0.8, 0.5 * math.pi, 2.5, -2.0, -0.6])
@pytest.mark.parametrize(
    ("off_rad", "is_mover"),
    [(math.pi, True), (math.pi - 0.8, True), (math.pi + 0.8, True), (0.0, False), (1.5, False)],
)
def test_what_approaches_moves_from_wherever_it_comes(
    beam_rad: float, off_rad: float, is_mover: bool
) -> None:
    track = observed(beam_rad + off_rad, 1.0, beam_rad)
    assert judged(track, 1.3, is_small=False).is_mover is is_mover


@pytest.mark.parametrize("course_rad", [0.0, 0.8, 0.5 * math.pi, 2.5, -2.0, -0.6])
def test_what_is_small_and_steady_moves_after_three_isolated_looks(course_rad: float) -> None:
    for isolated_count, is_mover in ((3, True), (2, False)):
        track = observed(course_rad, 1.0, course_rad)
        track.isolated_count = isolated_count
        assert judged(track, 1.3, is_small=True).is_mover is is_mover


def test_a_young_track_is_likely_to_move_late_in_a_voyage_too() -> None:
    for after_s, is_likely in ((0.7, True), (1.4, True), (1.6, False)):
        assert judged(observed(0.3, 1.0, 0.3, looks=3), after_s, is_small=True).is_likely_mover is is_likely
