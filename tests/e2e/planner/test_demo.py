"""`make demo`, the first command that a newcomer types: two programs, a plan, a voyage, a picture."""

import csv
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from patience import JOB_S

pytestmark = pytest.mark.realtime

DEMO = Path(__file__).parents[3] / "examples" / "demo.py"


def test_the_demonstration_ends_as_it_should_and_leaves_its_picture_plan_and_track(tmp_path: Path) -> None:
    command = [sys.executable, str(DEMO), "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=JOB_S, check=False)
    assert (done.returncode, done.stderr.count("Traceback")) == (0, 0), done.stdout + done.stderr
    assert re.search(r"result +as it should be", done.stdout), done.stdout
    assert (tmp_path / "demo.png").read_bytes().startswith(b"\x89PNG")
    plan = json.loads((tmp_path / "demo.plan").read_text(encoding="utf-8"))
    assert len(plan["mission"]["items"]) >= 5
    with (tmp_path / "track.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[-1]["time_s"]) > 100.0, "the voyage takes minutes of the boat's clock"
