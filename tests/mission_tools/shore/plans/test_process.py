"""The planner's process: limits, one at a time, and its end."""

import asyncio
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from mission_tools.shore.plans import launcher, process
from mission_tools.shore.plans.process import (
    MOST_WAITING,
    Planner,
    PlannerBusyError,
    PlannerError,
    PlannerMissingError,
)

pytest_plugins = ("server_fixtures",)
pytestmark = pytest.mark.slow

StandIn = Callable[[str], None]  # the source of another program

ENDLESS = "import time, os; open('pid', 'w').write(str(os.getpid())); time.sleep(600)"
CHILD = (
    "import subprocess, sys, time\n"
    "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])\n"
    "open('pid', 'w').write(str(child.pid)); time.sleep(600)"
)


def is_running(pid: int) -> bool:
    """Whether a process lives and is not just waiting to be reaped."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text("ascii").rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


@pytest.fixture
def planner_is(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> StandIn:
    """Let another program stand in for mission-plan."""

    def stand_in(source: str) -> None:
        (tmp_path / "stand_in.py").write_text(source, encoding="utf-8")
        (tmp_path / "launch.py").write_text(
            "import sys\n"
            f"sys.path[:0] = [{str(Path.cwd())!r}, {str(tmp_path)!r}]\n"
            "from mission_tools.shore.plans import launcher\n"
            "for name, one in launcher.PROGRAMS.items():\n"
            "    launcher.PROGRAMS[name] = one._replace(module='stand_in')\n"
            "launcher.main(sys.argv[1:])\n",
            encoding="utf-8",
        )
        monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{Path.cwd()}")
        monkeypatch.setattr(process, "_LAUNCHER", "launch")

    return stand_in


async def pid_in(folder: Path) -> int:
    """Of the process that has written it there."""
    file = folder / "pid"
    while not file.is_file() or not file.read_text("ascii"):
        await asyncio.sleep(0.01)
    return int(file.read_text("ascii"))


async def gone(pid: int) -> None:
    """Until a process has ended; the test's own timeout ends what never does."""
    while is_running(pid):
        await asyncio.sleep(0.01)


def folder_in(tmp_path: Path, name: str = "work") -> Path:
    folder = tmp_path / name
    folder.mkdir()
    return folder


def test_its_sentence_is_the_error_without_program_and_folder(tmp_path: Path) -> None:
    (tmp_path / "new.gpx").write_text("nothing", encoding="utf-8")
    with pytest.raises(PlannerError) as refused:
        asyncio.run(Planner().run(["new.gpx", "--as-route"], tmp_path))
    assert str(refused.value).startswith("new.gpx: line 1: not XML")
    with pytest.raises(PlannerError, match=r"^No such option: --nonsense"):
        asyncio.run(Planner().run(["lake", "--nonsense"], tmp_path))


async def test_after_its_time_it_is_ended_with_all_that_it_started(
    planner_is: StandIn, tmp_path: Path
) -> None:
    planner_is(CHILD)
    folder = folder_in(tmp_path)
    with pytest.raises(PlannerError, match="took more than"):
        await Planner(limit_s=5.0).run([], folder)
    await gone(await pid_in(folder))


@pytest.mark.parametrize("how", ["cancel", "close"])
async def test_it_ends_with_the_call_and_with_the_server(
    how: str, planner_is: StandIn, tmp_path: Path
) -> None:
    planner_is(ENDLESS)
    folder = folder_in(tmp_path)
    planner = Planner()
    call = asyncio.create_task(planner.run([], folder))
    pid = await pid_in(folder)
    if how == "cancel":
        call.cancel()
    else:
        planner.close()
    done = (await asyncio.gather(call, return_exceptions=True))[0]
    assert isinstance(done, asyncio.CancelledError | PlannerError)
    await gone(pid)
    if how == "close":
        with pytest.raises(PlannerBusyError, match="server ends"):
            await planner.run([], folder)


async def test_it_ends_with_a_server_that_is_killed(planner_is: StandIn, tmp_path: Path) -> None:
    planner_is(ENDLESS)
    folder = folder_in(tmp_path)
    server = (
        "import asyncio, pathlib, sys\n"
        "from mission_tools.shore.plans import process\n"
        "process._LAUNCHER = 'launch'\n"
        "asyncio.run(process.Planner().run([], pathlib.Path(sys.argv[1])))\n"
    )
    one = await asyncio.create_subprocess_exec(sys.executable, "-c", server, str(folder))
    pid = await pid_in(folder)
    one.kill()
    await one.wait()
    await gone(pid)


async def test_one_runs_at_a_time_a_few_wait_and_more_are_told_so(
    planner_is: StandIn, tmp_path: Path
) -> None:
    planner_is(ENDLESS)
    folders = [folder_in(tmp_path, f"work{n}") for n in range(MOST_WAITING + 1)]
    planner = Planner()
    calls = [asyncio.create_task(planner.run([], folder)) for folder in folders]
    first = await pid_in(folders[0])
    with pytest.raises(PlannerBusyError, match="Other plans"):
        await planner.run([], tmp_path)
    assert not any((folder / "report.json").exists() for folder in folders[1:])
    calls[0].cancel()
    second = await pid_in(folders[1])
    assert not is_running(first)
    planner.close()
    await asyncio.gather(*calls, return_exceptions=True)
    assert not is_running(second)
    assert not (folders[2] / "report.json").exists()


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("x = bytearray(4_000_000_000)", "ran out of memory"),
        ("open('big', 'wb').write(bytes(100_000_000))", "code 1|File too large"),
        ("import sys; sys.exit(3)", "code 3"),
        ("print('[' * 100_000)", "code 0"),
    ],
)
def test_it_stays_within_its_limits(source: str, said: str, planner_is: StandIn, tmp_path: Path) -> None:
    planner_is(source)
    folder = folder_in(tmp_path)
    with pytest.raises(PlannerError, match=said) as refused:
        asyncio.run(Planner().run([], folder))
    assert "Traceback" not in str(refused.value)
    assert (
        sum(one.stat().st_size for one in folder.iterdir())
        <= launcher.PROGRAMS[launcher.PLANNER].file_bytes + 100_000
    )


def test_it_is_nice_and_sees_no_input(planner_is: StandIn, tmp_path: Path) -> None:
    planner_is(
        "import json, os, sys\n"
        "print(json.dumps({'ok': True, 'nice': os.nice(0), 'in': sys.stdin.read(), 'at': os.getcwd()}))"
    )
    folder = folder_in(tmp_path)
    report = asyncio.run(Planner().run([], folder))
    assert report["nice"] == min(os.nice(0) + launcher.NICE, 19)
    assert report["in"] == ""
    assert report["at"] == str(folder)


def test_a_planner_without_its_packages_says_what_installs_them(planner_is: StandIn, tmp_path: Path) -> None:
    absent = "sys.modules['numpy'] = sys.modules['shapely'] = None"
    planner_is(f"import sys\n{absent}\nfrom mission_tools.cli.plan import main\nmain()")
    with pytest.raises(PlannerMissingError) as refused:
        asyncio.run(Planner().run(["lake"], folder_in(tmp_path)))
    assert "needs the extra 'planner'" in str(refused.value)
    assert "pip install '.[planner]'" in str(refused.value)


def test_a_chart_has_limits_of_its_own_and_names_its_own_extra(planner_is: StandIn, tmp_path: Path) -> None:
    folder = folder_in(tmp_path)
    planner_is(
        "import json, resource as r, sys\n"
        "limits = [r.getrlimit(one)[0] for one in (r.RLIMIT_AS, r.RLIMIT_FSIZE, r.RLIMIT_CPU)]\n"
        "json.dump([sys.argv, limits], open('told', 'w'))\n"
        "print('boat-survey: needs the extra \\'survey\\'', file=sys.stderr)\n"
        "sys.exit(2)"
    )
    with pytest.raises(PlannerMissingError, match=r"^boat-survey needs the extra 'survey'$"):
        asyncio.run(Planner().chart("1.bin", "pond.geojson", folder))
    words, limits = json.loads((folder / "told").read_text("utf-8"))
    assert words[1:] == ["chart", "1.bin", "--map", "pond.geojson", "--out", "chart"]
    assert limits == [2_000_000_000, 200_000_000, 300]
