"""Campaigns sailed: outcomes, workers, resumption, the table."""

import contextlib
import csv
import io
import json
import os
import select
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from companion.core.errors import ConfigError
from sitl.__main__ import run_program
from sitl.experiments.campaign.campaign import load_campaign
from sitl.experiments.mission_trial import run_mission
from sitl.experiments.result_log import NAME, ResultLog
from sitl.experiments.runner import cluster_pool
from sitl.experiments.trial import Task, Trial, attempt

pytestmark = pytest.mark.slow

SHORT = """
[run]
mission = "short.waypoints"
seeds = 2
[grid]
environment.current_m_s = [0.0, 0.2]
[[expect]]
figure = "completed"
at_least = {share}
"""
WPL = """QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t50.0\t-1.2\t0\t1
1\t0\t3\t16\t0\t0\t0\t0\t50.0001\t-1.2\t50\t1
"""


def campaign_in(folder: Path) -> Path:
    """The file of a campaign of four short runs."""
    (folder / "short.waypoints").write_text(WPL, encoding="utf-8")
    (folder / "short.toml").write_text(SHORT.format(share=1.0), encoding="utf-8")
    return folder / "short.toml"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return campaign_in(tmp_path)


class Sailed(NamedTuple):
    """A campaign that two workers have sailed. out: its folder; said: what the program printed."""

    file: Path
    out: Path
    said: dict[str, Any]


@pytest.fixture(scope="module")
def sailed(tmp_path_factory: pytest.TempPathFactory) -> Sailed:
    file = campaign_in(tmp_path_factory.mktemp("campaign"))
    out, printed = file.parent / "out", io.StringIO()
    with contextlib.redirect_stdout(printed):
        assert run_program(["campaign", str(file), "-o", str(out), "--workers", "2", "--json"]) == 0
    return Sailed(file, out, json.loads(printed.getvalue()))


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as table:
        return list(csv.DictReader(table))


def test_a_campaign_is_tabulated_judged_and_done(sailed: Sailed) -> None:
    _, out, said = sailed
    assert said["ended"] == {"completed": 4}
    assert said["expectations"][0]["is_met"] is True
    table = rows(out / "runs.csv")
    assert [row["run"] for row in table] == [str(n) for n in range(1, 5)]
    assert {row["environment.current_m_s"] for row in table} == {"0", "0.2"}
    assert all(float(row["cross_track_rms_m"]) < 2.0 and row["late_commands"] == "0" for row in table)
    assert "cpu_seconds" not in table[0]


def test_an_interrupted_campaign_goes_on_where_it_stopped(
    sailed: Sailed, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ran: list[int] = []

    class Pool:
        def __init__(self, most: int) -> None:
            self.most = most

        def __enter__(self) -> "Pool":
            return self

        def __exit__(self, *_: object) -> None:
            pass

        def run(self, task: Task, trials: list[Trial]) -> object:
            for trial in trials[: self.most]:
                ran.append(trial.number)
                yield attempt(task, trial)
            if self.most < len(trials):
                raise KeyboardInterrupt

    file, out = sailed.file, tmp_path / "out"
    monkeypatch.setattr("sitl.cli.campaign.local_pool", lambda _: Pool(3))
    assert run_program(["campaign", str(file), "-o", str(out)]) == 130
    assert "3 of 4 runs are kept" in capsys.readouterr().out
    with (out / NAME).open("ab") as ledger:
        ledger.write(b'{"number":4,"ended":"comp')  # what a power cut leaves
    monkeypatch.setattr("sitl.cli.campaign.local_pool", lambda _: Pool(99))
    assert run_program(["campaign", str(file), "-o", str(out)]) == 0
    assert ran == list(range(1, 5))
    assert (out / "runs.csv").read_bytes() == (sailed.out / "runs.csv").read_bytes()


def test_the_runs_of_another_campaign_are_not_taken_for_this_ones(file: Path) -> None:
    out = file.parent / "out"
    ResultLog(out, load_campaign(file)).close()
    file.write_text(SHORT.format(share=1.0) + "\n[sample]\ncount = 2\n", encoding="utf-8")
    with pytest.raises(ConfigError, match="holds the runs of another campaign: remove it"):
        ResultLog(out, load_campaign(file))
    (out / NAME).write_text("something else\n")
    with pytest.raises(ConfigError, match="not a campaign's runs"):
        ResultLog(out, load_campaign(file))


def test_workers_do_not_outlive_a_program_that_was_killed() -> None:
    program = (
        "import os, sys\n"
        "from sitl.experiments.runner import local_pool\n"
        "if __name__ == '__main__':\n"
        "    with local_pool(1) as pool:\n"
        "        print(pool.executor.submit(os.getpid).result(), flush=True)\n"
        "        sys.stdin.read()\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as parent:
        assert parent.stdout is not None
        worker = os.pidfd_open(int(parent.stdout.readline()))
        try:
            parent.kill()
            gone, _, _ = select.select([worker], [], [], 30.0)
        finally:
            os.close(worker)
    assert gone


def test_a_run_that_fails_is_a_result_with_its_reason(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bad_key = attempt(
        run_mission,
        Trial(number=1, scenario="open", seed=1, course="straight", settings={"hul": 1}, source="x"),
    )
    assert (bad_key.ended, bad_key.why) == ("error", "x: hul: no such setting")
    no_mission = attempt(
        run_mission, Trial(number=2, scenario="open", seed=1, mission=str(file.parent / "none.plan"))
    )
    assert no_mission.ended == "error"
    assert "none.plan" in no_mission.why
    monkeypatch.setattr("sitl.run.station_commands.BOOT_S", 5.0)
    low = {"vehicle": {"arming": {"battery_min_v": 50.0}}}
    refused = attempt(run_mission, Trial(number=3, scenario="open", seed=1, course="straight", settings=low))
    assert refused.ended == "refused"
    assert "armable" in refused.why


def test_a_defect_is_a_result_with_its_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    def stumble(*_: object, **__: object) -> None:
        raise ZeroDivisionError("a defect")

    monkeypatch.setattr("sitl.experiments.mission_trial.load_scenario", stumble)
    outcome = attempt(run_mission, Trial(number=1, scenario="open", seed=1, course="straight"))
    assert outcome.ended == "error"
    assert "ZeroDivisionError: a defect" in outcome.traceback


def test_a_run_that_does_not_arrive_says_where_it_was() -> None:
    outcome = attempt(run_mission, Trial(number=1, scenario="open", seed=1, course="straight", timeout_s=5.0))
    assert outcome.ended == "not completed"
    assert outcome.why.startswith("at item 1 of 1 in AUTO")
    assert outcome.figures["completed"] is False


def test_a_dask_cluster_sails_the_same_runs(file: Path) -> None:
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: the extra `cluster`")
    plan = load_campaign(file)
    with (
        distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster,
        cluster_pool(cluster.scheduler_address) as pool,
    ):
        outcomes = sorted(pool.run(run_mission, plan.runs[:2]), key=lambda outcome: outcome.number)
    alone = [attempt(run_mission, run) for run in plan.runs[:2]]
    assert [(o.ended, o.figures) for o in outcomes] == [(o.ended, o.figures) for o in alone]
