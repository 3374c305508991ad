"""The notebook that replays a log: its cells run on a log of the emulator, and are those of the script."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from pictures.notebook import NOTEBOOK, SCRIPT, notebook

from companion.log.logbook import Logbook
from companion.log.sink import SingleFile
from sitl.courses.missions import lay_out, wire_items
from sitl.run.mission_run import MissionRun
from sitl.scenarios.scenario import load_scenario

pytestmark = pytest.mark.slow

_CHECKOUT = Path(__file__).parents[3]


def test_the_notebook_is_the_script() -> None:
    """`python -m pictures` writes it."""
    assert (_CHECKOUT / NOTEBOOK).read_text() == notebook((_CHECKOUT / SCRIPT).read_text())


def test_the_cells_of_the_notebook_run_on_a_log(tmp_path: Path) -> None:
    scenario = load_scenario("open", ["vehicle.log.motion_hz=50"])
    logbook = Logbook(SingleFile(tmp_path / "a.bin"))
    MissionRun(scenario, wire_items(lay_out("straight", scenario)), logbook).run(timeout_s=25.0)
    cells = json.loads((_CHECKOUT / NOTEBOOK).read_text())["cells"]
    code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code, str(tmp_path / "a.bin")],
        capture_output=True,
        text=True,
        check=False,
        cwd=_CHECKOUT,
        env=os.environ | {"MPLBACKEND": "Agg"},
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert "velocity_north: NIS" in done.stdout
    assert (tmp_path / "a.png").stat().st_size > 10_000
