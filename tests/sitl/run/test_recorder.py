"""The figures of a run, against tracks whose figures are known."""

import csv
import math
from pathlib import Path

import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.maps.chart import build_chart
from sitl.run.recording.recorder import Recorder
from sitl.world.shore import Shore
from sitl.world.truth import Truth

FRAME = LocalFrame(LatLon(50.0, -1.2))
SEA = Shore(build_chart("sea", FRAME, None, ()), 1.0)
BASIN = Shore(build_chart("basin", FRAME, shapely.box(-20.0, -20.0, 20.0, 20.0), ()), 1.0)


def truth(time_s: float, north_m: float, east_m: float, *, grounded: bool = False) -> Truth:
    return Truth(time_s, north_m, east_m, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.5, grounded)


def recorded(*places: tuple[float, float, int]) -> Recorder:
    recorder = Recorder()
    for n, (north_m, east_m, leg) in enumerate(places):
        recorder.record(truth(0.5 * n, north_m, east_m), leg)
    return recorder


def test_cross_track_is_measured_from_the_leg_being_sailed_starboard_positive() -> None:
    recorder = recorded((5.0, 1.0, 0), (5.0, -2.0, 0), (12.0, 5.0, 1), (50.0, 50.0, -1))
    planned = [Point(0.0, 0.0), Point(10.0, 0.0), Point(10.0, 10.0)]
    # Leg 0 leads north: east of it is starboard. Leg 1 leads east: north of it is port.
    assert recorder.cross_track_m(planned).tolist() == pytest.approx([1.0, -2.0, -2.0])
    figures = recorder.metrics(planned, SEA)
    assert figures.cross_track_rms_m == pytest.approx(math.sqrt(3.0))
    assert figures.cross_track_max_m == pytest.approx(2.0)
    assert figures.path_length_m == pytest.approx(3.0 + math.hypot(7.0, 7.0) + math.hypot(38.0, 45.0))
    assert figures.time_s == 1.5


def test_on_a_leg_without_length_the_distance_to_its_point_counts() -> None:
    planned = [Point(1.0, 1.0), Point(1.0, 1.0)]
    assert recorded((4.0, 5.0, 0)).cross_track_m(planned).tolist() == pytest.approx([5.0])


def test_without_a_leg_there_is_no_cross_track_error() -> None:
    figures = recorded((0.0, 0.0, -1), (1.0, 0.0, -1)).metrics([], SEA)
    assert (figures.cross_track_rms_m, figures.cross_track_max_m) == (None, None)


def test_a_leg_that_is_not_in_the_plan_is_an_error() -> None:
    with pytest.raises(ValueError, match="leg 2 was recorded, but the plan has 3 points"):
        recorded((0.0, 0.0, 2)).metrics([Point(0, 0), Point(1, 0), Point(2, 0)], SEA)


def test_clearance_is_the_least_distance_to_the_shore() -> None:
    figures = recorded((0.0, 0.0, -1), (12.0, 3.0, -1), (5.0, -17.5, -1)).metrics([], BASIN)
    assert figures.min_clearance_m == pytest.approx(2.5)


def test_each_time_aground_counts_once() -> None:
    recorder = Recorder()
    for n, aground in enumerate([True, True, False, True, False, False, True]):
        recorder.record(truth(float(n), 0.0, 0.0, grounded=aground))
    assert recorder.metrics([], SEA).groundings == 3


def test_the_hash_covers_every_number_of_every_tick() -> None:
    base = [(0.0, 0.0, 0), (1.0, 2.0, 0)]
    hashes = {
        recorded(*places).state_hash()
        for places in (
            base,
            base[:1],
            [base[0], (1.0, math.nextafter(2.0, 3.0), 0)],
            [base[0], (1.0, 2.0, 1)],
        )
    }
    assert len(hashes) == 4
    assert recorded(*base).state_hash() == recorded(*base).state_hash()


def test_the_trajectory_file_has_a_row_per_kept_tick(tmp_path: Path) -> None:
    recorder = recorded(*[(float(n), -float(n), 0) for n in range(10)])
    recorder.write_csv(tmp_path / "track.csv", every=3)
    with (tmp_path / "track.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["north_m"]) for row in rows] == [0.0, 3.0, 6.0, 9.0]
    assert rows[1]["east_m"] == "-3.000000"
    assert (rows[0]["leg"], rows[0]["grounded"]) == ("0", "0")
