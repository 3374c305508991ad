"""An onboard log replayed through the estimator."""

import math
from pathlib import Path

import pytest

from companion.core.errors import ConfigError
from companion.log.logbook import Logbook
from companion.log.sink import SingleFile
from sitl.courses.missions import lay_out, wire_items
from sitl.run.mission_run import MissionRun
from sitl.run.recording.log_replay import LoggedRun, read_log
from sitl.scenarios.scenario import load_scenario


def _sail(path: Path, motion_hz: float) -> LoggedRun:
    scenario = load_scenario(
        "open",
        [
            f"vehicle.log.motion_hz={motion_hz}",
            "vehicle.log.disarmed=true",
            "vehicle.estimation.surge_time_s=2.5",
            "environment.current_m_s=0.3",
        ],
    )
    logbook = Logbook(SingleFile(path))
    MissionRun(scenario, wire_items(lay_out("straight", scenario)), logbook).run(timeout_s=25.0)
    return read_log(path)


def _largest_error(run: LoggedRun) -> tuple[float, float]:
    """In position (m) and heading (rad), after the start."""
    estimator = run.estimator()
    most_m = most_rad = 0.0
    for tick, nav in run.estimates(estimator):
        if nav is None or tick.logged is None or tick.now_s < 10.0:
            continue
        north_m, east_m, heading_rad = tick.logged
        most_m = max(most_m, math.hypot(nav.north_m - north_m, nav.east_m - east_m))
        most_rad = max(most_rad, abs(math.remainder(nav.heading_rad - heading_rad, math.tau)))
    return most_m, most_rad


def test_a_log_of_every_tick_replays_to_the_boats_own_estimates(tmp_path: Path) -> None:
    run = _sail(tmp_path / "a.bin", 50.0)
    assert run.config.estimation.surge_time_s == 2.5  # from the logged parameters
    most_m, most_rad = _largest_error(run)
    assert most_m < 0.02  # positions are logged to a centimetre
    assert most_rad < 4e-3  # readings are rounded


def test_a_file_that_is_no_log_of_the_boat_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.bin").write_bytes(b"")
    with pytest.raises(ConfigError, match=r"a\.bin"):
        read_log(tmp_path / "a.bin")
