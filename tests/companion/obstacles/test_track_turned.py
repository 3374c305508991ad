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


def judged(track: Track) -> Track:
    track.classify(0.2)
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
    assert judged(track).is_mover is is_mover
