"""Ctrl-C at any moment: exit code 130, no traceback, nothing left behind.

The moment is set by what the program imports: a `sitecustomize` sends SIGINT when a module is first asked
for, so that nothing depends on how fast the machine is.
"""

import asyncio
import signal
import threading
from pathlib import Path

import pytest
from patience import JOB_S
from programs import Program, RunProgram, processes_of, until

from mission_tools.vehicle.follow import in_thread

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

INTERRUPTED = 130
HOOK = """
import os, signal, sys

class Interrupter:
    def find_spec(self, name, path=None, target=None):
        if name == os.environ["INTERRUPT_AT"] and is_meant:
            sys.meta_path.remove(self)
            os.killpg(os.getpgid(0), signal.SIGINT)

is_worker = "--multiprocessing-fork" in sys.orig_argv
is_meant = is_worker == (os.environ["INTERRUPT_IN"] == "worker")
sys.meta_path.insert(0, Interrupter())
"""
CAMPAIGN = """
title = "the beginning of a leg"
[run]
scenario = "open"
course = "straight"
timeout_s = 5.0
seeds = 400
"""


@pytest.fixture
def hook(tmp_path: Path) -> Path:
    """A folder for PYTHONPATH."""
    (tmp_path / "hook").mkdir()
    (tmp_path / "hook" / "sitecustomize.py").write_text(HOOK, encoding="utf-8")
    return tmp_path / "hook"


@pytest.mark.parametrize(
    ("program", "argument", "module"),
    [
        ("boat-sitl", "--help", "sitl.cli.program"),
        ("boat-companion", "--help", "companion.app.cli"),
        ("mission-check", "--help", "argparse"),
        ("mission-plan", "lake", "shapely"),
        ("mission-upload", "--help", "mission_tools.cli.options"),
    ],
)
def test_an_interrupt_during_the_imports_is_one_line(
    run_program: RunProgram, hook: Path, program: str, argument: str, module: str
) -> None:
    environment = {"PYTHONPATH": str(hook), "INTERRUPT_AT": module, "INTERRUPT_IN": "program"}
    ended = run_program(program, argument, environment=environment).wait(JOB_S)
    assert (ended.code, ended.out, ended.err) == (INTERRUPTED, "", f"{program}: interrupted\n")


def campaign(run_program: RunProgram, folder: Path, **environment: str) -> Program:
    (folder / "two.toml").write_text(CAMPAIGN, encoding="utf-8")
    arguments = ("campaign", str(folder / "two.toml"), "-o", str(folder / "out"), "--workers", "2")
    return run_program("boat-sitl", *arguments, environment=environment)


def test_an_interrupt_while_campaign_workers_start_prints_no_traceback(
    run_program: RunProgram, hook: Path, tmp_path: Path
) -> None:
    environment = {"PYTHONPATH": str(hook), "INTERRUPT_AT": "companion.boat", "INTERRUPT_IN": "worker"}
    program = campaign(run_program, tmp_path, **environment)
    ended = program.wait(JOB_S)
    assert (ended.code, ended.err) == (INTERRUPTED, "boat-sitl: interrupted\n")
    assert "of 400 runs are kept: the same command continues" in ended.out
    until(lambda: not processes_of(program.pid), JOB_S)  # multiprocessing's own helper ends on its own


def test_an_interrupted_campaign_ends_at_once_and_goes_on_where_it_stopped(
    run_program: RunProgram, tmp_path: Path
) -> None:
    program = campaign(run_program, tmp_path)
    ledger = tmp_path / "out" / "runs.jsonl"
    until(lambda: ledger.exists() and ledger.read_text(encoding="utf-8").count("\n") > 1, JOB_S)
    program.send(signal.SIGINT)
    ended = program.wait(JOB_S)
    assert (ended.code, ended.err) == (INTERRUPTED, "boat-sitl: interrupted\n")
    assert "of 400 runs are kept: the same command continues" in ended.out
    until(lambda: not processes_of(program.pid), JOB_S)


def test_nobody_waits_for_planning_that_was_called_off() -> None:
    """An interrupt cancels the job; the planner's thread may need minutes more."""
    is_over = threading.Event()

    async def job() -> None:
        planning = asyncio.ensure_future(in_thread(is_over.wait))
        await asyncio.sleep(0.0)
        planning.cancel()
        with pytest.raises(asyncio.CancelledError):
            await planning

    asyncio.run(job())  # joins the threads of its default executor at its end
    is_over.set()
