import csv
import json
from pathlib import Path

import pytest

from sitl.__main__ import run_program
from sitl.world.truth import Truth

pytestmark = pytest.mark.slow

WPL = """QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t50.0\t-1.2\t0\t1
1\t0\t3\t16\t0\t0\t0\t0\t50.0001\t-1.2\t50\t1
2\t0\t3\t{command}\t0\t0\t0\t0\t50.0001\t-1.1998\t50\t1
"""


@pytest.fixture
def mission(tmp_path: Path) -> Path:
    """Two waypoints near the open scenario's start."""
    path = tmp_path / "short.waypoints"
    path.write_text(WPL.format(command=16), encoding="utf-8")
    return path


def test_figures_trajectory_and_picture_are_written_where_they_were_asked_for(
    mission: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, table, picture = tmp_path / "out" / "run.json", tmp_path / "a" / "track.csv", tmp_path / "track.png"
    files = ["--json", str(out), "--csv", str(table), "--png", str(picture)]
    assert run_program(["sail", "open", "--mission", str(mission), *files]) == 0
    figures = json.loads(out.read_text(encoding="utf-8"))
    assert {"seed", "time_s", "cross_track_rms_m", "real_time_factor", "state_hash"} <= set(figures)
    assert figures["completed"] is True
    assert (figures["waypoints_reached"], figures["min_clearance_m"]) == (2, None)
    assert "2 of 2" in capsys.readouterr().out
    with table.open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert rows[0] == [*Truth._fields, "leg"]
    assert len(rows) > 100
    assert picture.read_bytes().startswith(b"\x89PNG\r\n\x1a\n")


def test_settings_and_seed_of_the_command_line_change_the_voyage(
    mission: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def state_hash(*arguments: str) -> str:
        assert run_program(["sail", "open", "--mission", str(mission), "--json", *arguments]) == 0
        return str(json.loads(capsys.readouterr().out)["state_hash"])

    first = state_hash("--seed", "5")
    assert state_hash("--seed", "6") != first
    assert state_hash("--seed", "5", "--set", "environment.current_m_s=0.2") != first


def test_a_mission_that_is_not_completed_is_exit_code_one_in_one_line(
    mission: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_program(["sail", "open", "--mission", str(mission), "--timeout", "2"]) == 1
    error = capsys.readouterr().err
    assert "the mission was not completed: at item 1 of 2 in AUTO" in error


def test_figures_and_error_of_a_mission_that_is_not_completed_are_one_json_object(
    mission: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_program(["sail", "open", "--mission", str(mission), "--timeout", "2", "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert (told["ok"], told["exit_code"], told["completed"], told["waypoints"]) == (False, 1, False, 2)
    assert told["error"].startswith("the mission was not completed: at item 1")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["sail", "nowhere"], "nowhere: no such scenario"),
        (["sail", "open"], "no goal"),
        (["sail", "open", "--set", "environment.curent_m_s=1"], "curent_m_s"),
        (["sail", "pool", "--case", "9"], "9"),
        (["sail", "open", "--mission", "missing.plan"], "missing.plan"),
        (["sail", "open", "--warp"], "--warp"),
        (["serve", "open", "--speedup", "0"], "speedup"),
        (["serve", "open", "--tcp", "99999"], "tcp"),
    ],
)
def test_wrong_input_is_exit_code_two_in_one_line(
    arguments: list[str],
    words: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run_program(arguments) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
