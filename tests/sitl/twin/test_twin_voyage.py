import math
from pathlib import Path

import numpy as np
import pytest
from pymavlink.DFReader import DFReader_binary

from companion.core.errors import ConfigError
from companion.log.logbook import Logbook
from companion.log.sink import SingleFile
from sitl.courses.missions import wire_items
from sitl.run.mission_run import MissionRun
from sitl.run.recording.recorder import Rows
from sitl.scenarios.scenario import load_scenario
from sitl.twin.manoeuvres import trial_mission
from sitl.twin.voyage import Voyage, read_voyage
from sitl.world.truth import Truth


def sail(path: Path, rate_hz: int) -> tuple[Path, Voyage, Rows]:
    """The first two minutes of a trial voyage; the log, what is read, and the truth."""
    water = ["environment.wind_m_s=3", "environment.current_m_s=0.3", "seed=31"]
    scenario = load_scenario("open", [f"vehicle.log.motion_hz={rate_hz}", *water])
    mission = trial_mission(scenario.frame.origin, scenario.vehicle.speed.cruise_m_s)
    run = MissionRun(scenario, wire_items(mission), Logbook(SingleFile(path)))
    run.run(timeout_s=120.0)
    return path, read_voyage(path, 0.05), run.recorder.rows


@pytest.fixture(scope="module")
def sailed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Voyage, Rows]:
    """Logged at every tick."""
    return sail(tmp_path_factory.mktemp("voyage") / "a.bin", 50)


def test_commands_fixes_and_pack_are_those_that_another_reader_finds(
    sailed: tuple[Path, Voyage, Rows],
) -> None:
    path, voyage, _ = sailed
    with DFReader_binary(str(path), zero_time_base=True) as reader:
        records = list(iter(reader.recv_msg, None))
    outputs = [one for one in records if one.get_type() == "RCOU" and one.TimeUS >= 1e6 * voyage.start_s]
    count = min(len(outputs), len(voyage.left))
    assert count > 5000
    assert voyage.left[:count] == pytest.approx([(one.C1 - 1500) / 500 for one in outputs[:count]])
    assert voyage.right[:count] == pytest.approx([(one.C3 - 1500) / 500 for one in outputs[:count]])
    fixes = {one.TimeUS: one for one in records if one.get_type() == "GPS"}
    for time_s, north_m_s, east_m_s, *_ in voyage.fixes.tolist():
        fix = fixes[round(1e6 * time_s)]
        assert math.hypot(north_m_s, east_m_s) == pytest.approx(fix.Spd, abs=1e-6)
        assert math.degrees(math.atan2(east_m_s, north_m_s)) % 360.0 == pytest.approx(fix.GCrs, abs=1e-3)
    pack = {one.TimeUS: one for one in records if one.get_type() == "BAT"}
    assert all(pack[round(1e6 * t)].Volt == pytest.approx(v) for t, v, _ in voyage.pack.tolist())


def test_gyro_and_compass_together_give_the_true_turn_rate_and_heading(
    sailed: tuple[Path, Voyage, Rows],
) -> None:
    _, voyage, rows = sailed
    truth = {name: rows[:, n] for n, name in enumerate(Truth._fields)}
    times_s = voyage.start_s + voyage.step_s * np.arange(len(voyage.left))
    at = (truth["time_s"] > times_s[100]) & (truth["time_s"] < times_s[-100])
    rate = np.interp(truth["time_s"][at], times_s, voyage.rate_rad_s)
    scale = float(rate @ truth["yaw_rate_rad_s"][at] / (rate @ rate))
    assert scale == pytest.approx(1.0, abs=0.01)  # the gyro's own is 1.02
    off = np.degrees(
        np.interp(truth["time_s"][at], times_s, voyage.heading_rad) - np.unwrap(truth["heading_rad"][at])
    )
    assert off.std() < 0.6  # of 0.8° white and up to 4° in turns
    # The command in force during a tick is the one logged at its beginning.
    assert np.interp(truth["time_s"][at], times_s + 0.02, voyage.left) == pytest.approx(
        truth["left_command"][at], abs=2e-3
    )


def test_commands_of_a_slow_log_are_not_late(tmp_path: Path) -> None:
    _, voyage, rows = sail(tmp_path / "slow.bin", 10)
    truth = {name: rows[:, n] for n, name in enumerate(Truth._fields)}
    times_s = voyage.start_s + voyage.step_s * np.arange(len(voyage.left))
    for name, commands in (("left_command", voyage.left), ("right_command", voyage.right)):
        before, true, after = (
            np.interp(times_s + 0.02 + late_s, truth["time_s"], truth[name]) for late_s in (-0.05, 0.0, 0.05)
        )
        slope = (after - before) / 0.1
        assert abs(slope @ (true - commands) / (slope @ slope)) < 0.01  # s; 0.03 for those held


def test_the_packs_resistance_is_found_from_its_load(sailed: tuple[Path, Voyage, Rows]) -> None:
    _, voyage, _ = sailed
    assert voyage.pack_ohm == pytest.approx(0.05, rel=0.1)
    assert np.all(np.diff(voyage.open_v) < 1e-4)
    assert 12.0 < voyage.open_v[0] < 12.7


@pytest.mark.parametrize(
    ("data", "message"),
    [(b"", "not a log"), (bytes(4000), "not a log"), (None, "cannot be read")],
)
def test_a_file_that_is_no_log_is_named(tmp_path: Path, data: bytes | None, message: str) -> None:
    path = tmp_path / "x.bin"
    if data is not None:
        path.write_bytes(data)
    with pytest.raises(ConfigError, match=rf"x\.bin: {message}"):
        read_voyage(path, 0.05)


def test_a_log_that_is_too_short_says_so(sailed: tuple[Path, Voyage, Rows], tmp_path: Path) -> None:
    path = tmp_path / "short.bin"
    path.write_bytes(sailed[0].read_bytes()[:400_000])
    with pytest.raises(ConfigError, match=r"short\.bin: .* s of a voyage: expected a minute at least"):
        read_voyage(path, 0.05)
