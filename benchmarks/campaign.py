"""How much faster is a campaign on two cores?"""

import time

from benchmarks.measure import Row, alone
from sitl.experiments.mission_trial import run_mission
from sitl.experiments.runner import cores, local_pool
from sitl.experiments.trial import Trial

_RUNS = 16
_ROUNDS = 3


def rows() -> list[Row]:
    """The same runs with one worker and with two, in turn, workers' start included and apart."""
    question = f"campaign of {_RUNS} straights: wall clock with one worker ÷ with two"
    if cores() < 2:
        return [alone(question, "×", "more", [1.0], "this machine has one core")]
    _seconds(1, 2)
    ratios = [_seconds(1, _RUNS) / _seconds(2, _RUNS) for _ in range(_ROUNDS)]
    return [alone(question, "×", "more", ratios, "on an idle machine, without the workers' start")]


def _seconds(workers: int, count: int) -> float:
    runs = [Trial(number=n, scenario="open", seed=n, course="straight") for n in range(1, count + 1)]
    with local_pool(workers) as pool:
        list(pool.run(run_mission, runs[: 2 * workers]))  # every worker has imported what it needs
        began_s = time.perf_counter()
        outcomes = list(pool.run(run_mission, runs))
        taken_s = time.perf_counter() - began_s
    assert all(outcome.ended == "completed" for outcome in outcomes)
    return taken_s
