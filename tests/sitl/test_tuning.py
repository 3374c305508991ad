"""The search for gains, against costs that are known; and one real comparison, small."""

from pathlib import Path

import pytest

from companion.config import BoatConfig
from companion.params import Parameters
from companion.params_table import ROWS
from companion.storage import MemoryStorage
from sitl.campaign.run import Outcome, Run
from sitl.scenario import load_scenario
from sitl.sensors import generator
from sitl.tuning.gains import TUNED, Gains, drawn_around, gains_of, parameter_file, settings_of
from sitl.tuning.search import search
from sitl.tuning.trial import FAILED, Trials

POOL = load_scenario("open", ["boat.model=pool"])
WANTED = {"heading.kp": 9.0, "heading.ki": 1.0, "heading.kd": 2.5, "speed.kp": 3.0, "speed.ki": 1.0}


def trials(folder: Path) -> Trials:
    return Trials("pool", POOL.vehicle, POOL.frame, folder)


def distance(run: Run) -> float:
    """How far a run's gains are from those wanted, in factors of e."""
    vehicle = run.settings["vehicle"]
    found: Gains = {path: vehicle[path.partition(".")[0]][path.partition(".")[2]] for path in TUNED}
    return sum(abs(found[path] / WANTED[path] - 1.0) for path in TUNED)


def pretend(runs: list[Run]) -> list[Outcome]:
    """Runs whose cross-track error is the distance to the wanted gains, with some noise."""
    figures = {"cross_track_max_m": 0.0, "overshoot_m": 0.0, "command_travel_per_s": 0.0}
    return [
        Outcome(
            number=run.number,
            ended="completed",
            figures={
                **figures,
                "cross_track_rms_m": distance(run) + 0.02 * generator(run.seed, "x").random(),
            },
        )
        for run in runs
    ]


def test_the_search_comes_near_the_gains_that_cost_least(tmp_path: Path) -> None:
    first = gains_of(POOL.vehicle)
    standings = list(search(trials(tmp_path), first, 1, pretend, candidates=40))
    costs = [standing.cost for standing in standings]
    assert standings[-1].round == 3
    assert costs[-1] < 0.5 * trials(tmp_path).cost(pretend(trials(tmp_path).runs(first, range(1, 5), 1)))


def test_the_same_search_asks_for_the_same_runs_under_the_same_numbers(tmp_path: Path) -> None:
    def asked() -> list[Run]:
        runs: list[Run] = []

        def sail(batch: list[Run]) -> list[Outcome]:
            runs.extend(batch)
            return pretend(batch)

        list(search(trials(tmp_path), gains_of(POOL.vehicle), 5, sail, candidates=8))
        return runs

    once = asked()
    assert asked() == once
    assert [run.number for run in once] == list(range(1, len(once) + 1))


def test_the_gains_to_begin_with_win_where_nothing_is_better(tmp_path: Path) -> None:
    standings = list(search(trials(tmp_path), WANTED, 2, pretend, candidates=8))
    assert standings[-1].best == WANTED


def test_what_is_drawn_stays_within_reach_and_has_few_digits() -> None:
    drawn = drawn_around(WANTED, 2.0, 50, generator(3, "test"))
    assert len(drawn) == 50
    for gains in drawn:
        for path, value in gains.items():
            assert WANTED[path] / 2.01 <= value <= WANTED[path] * 2.01
            assert value == float(f"{value:.3g}")


def test_the_parameter_file_is_one_that_the_boat_loads() -> None:
    gains: Gains = {**WANTED, "heading.ki": 0.123}
    storage = MemoryStorage()
    storage.save("params.parm", parameter_file(gains, ["found by a test"]).encode())
    assert gains_of(Parameters(BoatConfig(), ROWS, storage).config) == pytest.approx(gains)


def test_gains_become_settings_of_the_vehicle() -> None:
    assert settings_of({"heading.kp": 2.0, "speed.ki": 0.1}) == {
        "vehicle": {"heading": {"kp": 2.0}, "speed": {"ki": 0.1}}
    }


def test_a_run_that_is_not_completed_costs_more_than_any_that_is(tmp_path: Path) -> None:
    lost = Outcome(number=1, ended="not completed", figures={"cross_track_rms_m": 0.0})
    assert trials(tmp_path).cost([lost]) == FAILED
