"""What the planner's programs do not load: a module that is not needed costs CPU time at every start."""

import json
import subprocess
import sys

import pytest

HEAVY = ("asyncio", "matplotlib", "mavsdk", "pymavlink", "rich", "serial")
PLANS_WITHOUT = (*HEAVY, "numpy.testing", "pyproj", "scipy", "mission_tools.tasks.survey")
HELPS_WITHOUT = (*PLANS_WITHOUT, "msgspec", "numpy", "shapely")


def loaded_by(code: str) -> set[str]:
    """The modules that a fresh interpreter has loaded after this code."""
    ask = "; import json, sys; sys.stderr.write(json.dumps(sorted(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code + ask], capture_output=True, text=True, check=True
    )
    return set(json.loads(done.stderr))


@pytest.mark.parametrize("program", ["plan", "upload", "check"])
def test_help_loads_no_arithmetic_and_no_link(program: str) -> None:
    loaded = loaded_by(f"from mission_tools.cli.{program} import run_program; run_program(['--help'])")
    assert loaded.isdisjoint(HELPS_WITHOUT), loaded & set(HELPS_WITHOUT)


@pytest.mark.parametrize(
    "call",
    [
        "plan import run_program; run_program(['lake'])",
        "upload import run_program; run_program(['lake', '--dry-run'])",
    ],
)
def test_planning_loads_no_link_no_picture_and_no_screen(call: str) -> None:
    loaded = loaded_by(f"from mission_tools.cli.{call}")
    assert loaded.isdisjoint(PLANS_WITHOUT), loaded & set(PLANS_WITHOUT)
