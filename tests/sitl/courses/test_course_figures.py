"""The figures of a course, on tracks that are known."""

import math

import pytest

from companion.core.geo import LatLon, LocalFrame, Point
from sitl.courses.courses import corners_sailed, course_mission, tracking
from sitl.run.recording.recorder import Recorder
from sitl.world.truth import Truth

PLANNED = [Point(0.0, 0.0), Point(10.0, 0.0), Point(10.0, 10.0)]  # a right angle to starboard


def recorded(*places: tuple[float, float, int]) -> Recorder:
    recorder = Recorder()
    for tick, (north_m, east_m, leg) in enumerate(places):
        values = dict.fromkeys(Truth._fields, 0.0)
        values |= {"time_s": 0.02 * tick, "north_m": north_m, "east_m": east_m}
        recorder.record(Truth(**values), leg)  # type: ignore[arg-type]
    return recorder


def test_a_cut_corner_is_no_overshoot_but_a_cross_track_error() -> None:
    cut = recorded((6.0, 0.0, 0), (9.0, 1.0, 1), (10.0, 5.0, 1))
    (corner,) = corners_sailed(cut, PLANNED)
    assert tuple(corner) == pytest.approx((0.0, math.sqrt(2.0)))
    figures = tracking(cut, PLANNED)
    assert figures["kept_max_m"] == pytest.approx(1.0)
    assert figures["overshoot_m"] == 0.0
    assert figures["cut_m"] == pytest.approx(math.sqrt(2.0))


def test_figures_of_corners_are_those_of_the_worst_one_that_was_reached() -> None:
    planned = [*PLANNED, Point(20.0, 10.0), Point(20.0, 20.0)]
    sailed = recorded((9.5, 0.0, 0), (10.2, 1.0, 1), (10.0, 9.0, 1), (10.3, 9.8, 2), (30.0, 10.0, 2))
    first, second = corners_sailed(sailed, planned)
    assert tuple(first) == pytest.approx((0.2, 0.5))
    assert tuple(second) == pytest.approx((0.0, math.hypot(0.3, 0.2)))
    figures = tracking(sailed, planned)
    assert figures["overshoot_m"] == pytest.approx(0.2)
    assert figures["cut_m"] == pytest.approx(0.5)


def test_the_overshoot_is_how_far_the_boat_goes_beyond_the_new_leg() -> None:
    (corner,) = corners_sailed(recorded((10.3, 0.5, 1), (10.4, 2.0, 1), (9.0, 5.0, 1)), PLANNED)
    assert corner.beyond_m == pytest.approx(0.4)
    to_port = [Point(0.0, 0.0), Point(10.0, 0.0), Point(10.0, -10.0)]
    (corner,) = corners_sailed(recorded((10.3, -0.5, 1), (9.9, -2.0, 1)), to_port)
    assert corner.beyond_m == pytest.approx(0.3)


def test_the_path_error_is_to_the_nearest_place_of_the_line() -> None:
    figures = tracking(recorded((9.0, 2.0, 1), (12.0, 12.0, 1)), PLANNED)
    assert figures["path_max_m"] == pytest.approx(math.hypot(2.0, 2.0))
    assert figures["kept_max_m"] == pytest.approx(2.0)


def test_what_the_boat_is_carried_aside_before_it_has_way_is_said_apart() -> None:
    straight = [Point(0.0, 0.0), Point(200.0, 0.0)]
    figures = tracking(recorded((0.0, 3.0, 0), (14.0, 1.0, 0), (16.0, 0.2, 0), (150.0, -0.2, 0)), straight)
    assert figures["start_max_m"] == pytest.approx(3.0)
    assert figures["kept_rms_m"] == pytest.approx(0.2)
    assert figures["kept_max_m"] == pytest.approx(0.2)
    assert tracking(recorded((0.0, 3.0, 0), (14.0, 1.0, 0)), straight) == {}


def test_a_course_is_laid_out_from_where_the_boat_lies() -> None:
    frame = LocalFrame(LatLon(50.0, -1.2))
    mission = course_mission("straight", frame, Point(5.0, 7.0))
    (item,) = mission.items
    assert item.place is not None
    at = frame.to_local(item.place)
    assert (at.north_m, at.east_m) == pytest.approx((205.0, 7.0), abs=0.02)
