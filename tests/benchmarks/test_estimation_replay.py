"""Recordings of the estimator's inputs, and estimators replayed on them."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks.estimation.cases import Case, courses, environment, faults, record
from benchmarks.estimation.compare import compare, table
from benchmarks.estimation.errors import errors, figures
from benchmarks.estimation.feed import NAV, estimates, inputs_of
from companion.core.errors import ConfigError
from companion.core.state import EstimateFault
from sitl.run.estimate_recorder import Estimate
from sitl.run.mission_run import MissionRun
from sitl.run.sensor_recorder import SensorRecorder, SensorRecording
from sitl.scenarios.missions import lay_out, wire_items
from sitl.scenarios.scenario import load_scenario
from sitl.world.world import Truth

_CHECKOUT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def run() -> tuple[MissionRun, SensorRecording]:
    scenario = load_scenario("open", ["environment.current_m_s=0.3"])
    recorder = SensorRecorder()
    mission_run = MissionRun(scenario, wire_items(lay_out("straight", scenario)), sensors=recorder)
    mission_run.run(timeout_s=30.0)
    return mission_run, recorder.recording(scenario, "straight")


def _estimates(
    recording: SensorRecording, every: int = 5
) -> "np.ndarray[tuple[int, int], np.dtype[np.float64]]":
    inputs = inputs_of(recording.fixes, recording.headings, recording.ticks)
    return estimates(recording.settings, inputs, recording.frame, every)[0]


def test_a_replay_gives_the_estimates_that_the_boat_had(run: tuple[MissionRun, SensorRecording]) -> None:
    mission_run, recording = run
    rows = mission_run.estimates.rows
    nav = _estimates(recording, every=1)
    names = ("north_m", "east_m", "heading_rad", "surge_m_s", "current_north_m_s", "current_east_m_s")
    compared = 0
    for row in rows[::20]:  # rows of the run lie a tick later, after the world's step
        at = np.flatnonzero(np.isclose(nav[:, 0], row[0] - 0.02, atol=1e-6))
        if len(at):
            compared += 1
            for name in names:
                assert nav[at[0], NAV.index(name)] == pytest.approx(
                    row[Estimate._fields.index(name)], abs=1e-9
                ), name
    assert compared > 5


def test_truth_and_replayed_estimates_are_of_the_same_times(run: tuple[MissionRun, SensorRecording]) -> None:
    _, recording = run
    nav = _estimates(recording)
    assert len(nav) == len(recording.truth)
    known = ~np.isnan(nav[:, 0])
    assert nav[known, 0] == pytest.approx(recording.truth[known, 0])


def test_a_recording_survives_the_disk(run: tuple[MissionRun, SensorRecording], tmp_path: Path) -> None:
    _, recording = run
    recording.save(tmp_path / "a.npz")
    loaded = SensorRecording.load(tmp_path / "a.npz")
    for field in dataclasses.fields(SensorRecording):
        before, after = getattr(recording, field.name), getattr(loaded, field.name)
        assert np.array_equal(before, after) if isinstance(before, np.ndarray) else before == after, (
            field.name
        )


def test_another_file_is_not_taken_for_a_recording(tmp_path: Path) -> None:
    (tmp_path / "a.npz").write_bytes(b"no recording")
    with pytest.raises(ConfigError, match=r"a\.npz: not a recording of sensors"):
        SensorRecording.load(tmp_path / "a.npz")


def test_checkouts_are_compared_by_their_own_interpreters(
    run: tuple[MissionRun, SensorRecording], tmp_path: Path
) -> None:
    _, recording = run
    recording.save(tmp_path / "straight_1.npz")
    found = compare([tmp_path / "straight_1.npz"], [_CHECKOUT, _CHECKOUT])
    first, second = (one["straight"][0] for one in found)
    assert first["position_rms"] == second["position_rms"] > 0.0
    assert "| straight | 0 | " in table(found)


def test_errors_of_known_estimates_are_as_calculated_by_hand() -> None:
    truth, nav = np.zeros((2, len(Truth._fields))), np.zeros((2, len(NAV)))
    nav[0, NAV.index("north_m")], nav[0, NAV.index("east_m")] = 3.0, 4.0
    nav[0, NAV.index("heading_rad")] = math.radians(179.0)
    truth[0, Truth._fields.index("heading_rad")] = math.radians(-179.0)
    nav[0, NAV.index("current_east_m_s")] = 0.2
    found = errors(nav, truth)
    assert found["position"].tolist() == [5.0, 0.0]
    assert found["heading"] == pytest.approx([2.0, 0.0])
    assert found["current"].tolist() == [0.2, 0.0]


def test_noticing_times_and_false_alarms_are_counted_from_the_fault() -> None:
    times = np.arange(0.0, 80.0, 0.1)
    truth, nav = np.zeros((len(times), len(Truth._fields))), np.zeros((len(times), len(NAV)))
    truth[:, 0] = nav[:, 0] = times
    bits = nav[:, NAV.index("faults")]
    bits[(times > 19.95) & (times < 20.95)] = int(EstimateFault.GNSS_JUMPING)  # false
    bits[times > 31.95] = int(EstimateFault.COMPASS_OFF)  # of another sensor
    bits[times > 32.95] = int(EstimateFault.COMPASS_OFF | EstimateFault.GNSS_JUMPING)
    bits[times > 64.95] = 0
    fault = {"what": "gnss", "kind": "wrong", "at_s": 30.0, "for_s": 30.0}
    recording = SensorRecording({"faults": [fault]}, nav, [], [], truth, (0.0, 0.0))
    found = figures(recording, {"nav": nav, "cpu_us": 1.0})
    assert found["notice_s"] == pytest.approx(2.0)
    assert found["own_s"] == pytest.approx(3.0)
    assert found["clear_s"] == pytest.approx(4.9)
    assert found["false_s"] == pytest.approx(1.0)


def test_cases_have_a_name_each_and_their_settings_are_accepted() -> None:
    cases = [*courses(range(1, 3)), *faults(range(1, 3))]
    assert len({case.name for case in cases}) == len(cases)


@pytest.mark.parametrize("hull_fault", [{}, {"faults": [{"what": "gyro", "kind": "off", "at_s": 0.0}]}])
def test_a_case_is_recorded_with_its_settings(hull_fault: dict[str, object]) -> None:
    case = Case("a", "straight", 3, {"environment": environment(0.5), **hull_fault}, timeout_s=15.0)
    recording, is_completed = record(case)
    assert not is_completed
    assert recording.settings["seed"] == 3
    assert recording.settings["environment"]["gust_m_s"] == 8.0
    has_gyro = recording.headings[-1]["yaw_rate_rad_s"] is not None
    assert has_gyro is not bool(hull_fault)
