"""The search for gains, against costs that are known; and one real comparison, small."""

import json
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from statistics import fmean

import pytest

from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.core.storage import MemoryStorage
from sitl.__main__ import run_program
from sitl.experiments.trial import Figures, Task, Trial, TrialResult
from sitl.experiments.tuning.problem import FAILED, TUNED, Gains, TuningProblem, gains_of
from sitl.experiments.tuning.search import compare, search
from sitl.scenarios.scenario import load_scenario
from sitl.world.sampling import generator

POOL = load_scenario("open", ["boat.model=pool"])
WANTED = {"heading.kp": 9.0, "heading.ki": 1.0, "heading.kd": 2.5, "speed.kp": 3.0, "speed.ki": 1.0}


def trials(folder: Path) -> TuningProblem:
    return TuningProblem("pool", POOL.vehicle, POOL.frame, folder)


def distance(run: Trial) -> float:
    """How far a run's gains are from those wanted, in factors of e."""
    vehicle = run.settings["vehicle"]
    found: Gains = {path: vehicle[path.partition(".")[0]][path.partition(".")[2]] for path in TUNED}
    return sum(abs(found[path] / WANTED[path] - 1.0) for path in TUNED)


def pretend(runs: list[Trial]) -> list[TrialResult]:
    """Runs whose cross-track error is the distance to the wanted gains, with some noise."""
    figures = {"kept_max_m": 0.0, "overshoot_m": 0.0, "command_travel_per_s": 0.0}
    return [
        TrialResult(
            number=run.number,
            ended="completed",
            figures={
                **figures,
                "kept_rms_m": 0.1 + distance(run) + 0.02 * generator(run.seed, "x").random(),
            },
        )
        for run in runs
    ]


def test_the_search_comes_near_the_gains_that_cost_least(tmp_path: Path) -> None:
    first = gains_of(POOL.vehicle)
    rankings = list(search(trials(tmp_path), first, 1, pretend, candidates=40))
    assert rankings[-1].round == 3
    assert rankings[-1].ratios[0] < 0.5
    assert list(rankings[-1].ratios) == sorted(rankings[-1].ratios)
    found, before = (
        fmean(map(distance, trials(tmp_path).trials(gains, range(1), 1)))
        for gains in (rankings[-1].best, first)
    )
    assert found < 0.5 * before


def outcome(rms_m: float, ended: str = "completed") -> TrialResult:
    """A run that came out like that."""
    figures: Figures = {
        "kept_rms_m": rms_m,
        "kept_max_m": 0.0,
        "overshoot_m": 0.0,
        "command_travel_per_s": 0.0,
    }
    return TrialResult(number=1, ended=ended, figures=figures)


def test_a_run_that_is_not_completed_costs_more_than_any_that_is(tmp_path: Path) -> None:
    assert trials(tmp_path).cost(outcome(0.0, "not completed")) == FAILED


def test_what_may_be_chance_is_not_better() -> None:
    assert compare([0.90, 0.92, 0.88, 0.91]).is_better
    assert not compare([0.5, 1.4, 0.8, 1.2]).is_better
    assert not compare([1.0] * 6).is_better
    assert not compare([1.1, 1.12, 1.09]).is_better


class Pool:
    """Stands in for the pool of `tune`; raises after this many trials, as Ctrl-C does."""

    def __init__(self, most: int) -> None:
        self.left = most

    def __enter__(self) -> "Pool":
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def run(self, task: Task, trials: list[Trial]) -> Iterator[TrialResult]:
        """Results, until the interruption."""
        for one in pretend(trials):
            if self.left == 0:
                raise KeyboardInterrupt
            self.left -= 1
            yield one


def tuned(folder: Path, monkeypatch: pytest.MonkeyPatch, most: int = 10_000) -> tuple[int, int]:
    """The exit code of `boat-sitl tune pool`, and how many runs it has sailed."""
    pool = Pool(most)
    monkeypatch.setattr(import_module("sitl.cli.tune"), "local_pool", lambda _: pool)
    code = run_program(["tune", "pool", "-o", str(folder), "--candidates", "6", "--json"])
    return code, most - pool.left


def test_after_an_interruption_the_same_command_goes_on_to_the_same_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code, all_runs = tuned(tmp_path / "whole", monkeypatch)
    whole = json.loads(capsys.readouterr().out)
    assert code == 0
    assert tuned(tmp_path / "parts", monkeypatch, most=20) == (130, 20)
    assert "20 runs are kept" in capsys.readouterr().err
    assert tuned(tmp_path / "parts", monkeypatch) == (0, all_runs - 20)
    parts = json.loads(capsys.readouterr().out)
    assert {**parts, "file": whole["file"]} == whole


def test_what_is_written_is_what_was_judged_better(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    tuned(tmp_path, monkeypatch)
    told = json.loads(capsys.readouterr().out)
    assert told["is_better"]
    storage = MemoryStorage()
    storage.save("params.parm", (tmp_path / "tuned.parm").read_bytes())
    assert gains_of(Parameters(BoatConfig(), ROWS, storage).config) == pytest.approx(told["best"])
    assert (tmp_path / "tuning.png").stat().st_size > 10_000
