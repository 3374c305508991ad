"""What an emulated boat remembers from one start to the next, and where."""

import os
from pathlib import Path

import pytest
from boat_rig import scenario
from fake_clock import FakeClock

from companion.core.modes import Mode
from companion.core.requests import SetHome
from sitl.run.serve import Server
from sitl.run.simulated_boat import BoatOptions, SimulatedBoat
from sitl.run.state_folder import StateInUseError, default_folder, lock_folder


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("XDG_STATE_HOME", raising=False)
    return tmp_path


def test_the_usual_folder_is_that_of_scenario_and_port(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the XDG base directory specification: $XDG_STATE_HOME, or ~/.local/state where that is not set."""
    assert default_folder("lake", 1, 5760) == home / ".local/state/mavboat/lake-5760"
    assert default_folder("lake", 1, 5770) == home / ".local/state/mavboat/lake-5770"
    assert default_folder("lake", 1, None) == home / ".local/state/mavboat/lake-udp"
    monkeypatch.setenv("XDG_STATE_HOME", str(home / "elsewhere"))
    assert default_folder("lake", 1, 5760) == home / "elsewhere/mavboat/lake-5760"


def test_other_water_is_another_folder(home: Path) -> None:
    sources = [("lake", 1), ("pool", 1), ("random", 1), ("random", 2), ("lake.toml", 1), ("b/lake.toml", 1)]
    assert len({default_folder(source, seed, 5760) for source, seed in sources}) == len(sources)
    assert default_folder("lake", 1, 5760) == default_folder("lake", 2, 5760)


def test_one_folder_is_for_one_emulator_at_a_time(tmp_path: Path) -> None:
    first = lock_folder(tmp_path / "state")
    with pytest.raises(StateInUseError, match="another boat-sitl stores there"):
        lock_folder(tmp_path / "state")
    os.close(first)
    os.close(lock_folder(tmp_path / "state"))


def sail(folder: Path, *, is_cut: bool) -> None:
    """A boat that is under way with a mission when its program ends: by the power, or as it should."""
    clock = FakeClock()
    simulated = SimulatedBoat(scenario("open"), [], clock, BoatOptions(state_folder=str(folder)))
    server = Server([simulated], clock)
    vehicle = simulated.boat.vehicle

    def begin() -> bool:
        if clock.time_s > 4.0 and not vehicle.armed:
            vehicle.mode = Mode.RTL
            vehicle.request(SetHome(scenario("open").frame.to_global(scenario("open").start)))
            vehicle.arm(force=True)
        return clock.time_s > 8.0

    if is_cut:
        server._runner.run(begin)
        simulated._storage.close()
        simulated._close_files()
    else:
        server.run(begin)
    assert vehicle.armed


@pytest.mark.parametrize("is_cut", [True, False])
def test_only_a_power_cut_leaves_a_voyage_to_take_up(tmp_path: Path, is_cut: bool) -> None:
    """After a regular end the emulated boat lies at its start again, and has nothing to take up."""
    sail(tmp_path, is_cut=is_cut)
    clock = FakeClock()
    simulated = SimulatedBoat(scenario("open"), [], clock, BoatOptions(state_folder=str(tmp_path)))
    assert bool(simulated.boat.resume._offer) is is_cut
    Server([simulated], clock).run(lambda: True)
