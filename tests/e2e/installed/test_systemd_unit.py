"""The unit of examples/: as systemd reads it, and its program as its own user in an empty folder."""

import configparser
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from patience import JOB_S
from programs import SCRIPTS, RunProgram

from companion.app.install.plan import unit_text
from companion.app.status_file import RUNTIME_DIRECTORY
from companion.config.boat_config import load_config

pytest_plugins = ("program_fixtures",)

ROOT = Path(__file__).parents[3]
UNIT = (ROOT / "examples" / "mavboat.service").read_text(encoding="utf-8")
BOAT = ROOT / "examples" / "configs" / "boat.toml"
NOBODY = 65534
needs_systemd_analyze = pytest.mark.skipif(
    shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed"
)
MOCK_PINS = {"GPIOZERO_PIN_FACTORY": "mock", "GPIOZERO_MOCK_PIN_CLASS": "mockpwmpin"}
LISTENING = """
links = ["tcpin:127.0.0.1:0"]
parts.motors.driver = "l298n"
external = { position = 2, heading = 2 }
storage.folder = "state"
"""


def service() -> dict[str, str]:
    """The unit's settings for its program."""
    parser = configparser.ConfigParser(interpolation=None, strict=False)  # some settings are lists
    parser.optionxform = str  # type: ignore[assignment,method-assign]
    parser.read_string(UNIT)
    assert parser["Unit"]["StartLimitIntervalSec"] == "0", "five quick failures would end the boat for good"
    return dict(parser["Service"])


def test_the_example_is_the_unit_that_is_installed() -> None:
    assert unit_text() == UNIT


def analyze(*arguments: str) -> tuple[int, list[str]]:
    """systemd-analyze's exit code, and its lines on the unit."""
    command = ["systemd-analyze", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=JOB_S, check=False)
    return done.returncode, [line for line in (done.stdout + done.stderr).splitlines() if "mavboat" in line]


@needs_systemd_analyze
def test_systemd_has_nothing_to_say_against_it(tmp_path: Path) -> None:
    unit = tmp_path / "mavboat.service"
    unit.write_text(unit_text(SCRIPTS), encoding="utf-8")
    assert analyze("verify", "--man=no", str(unit)) == (0, [])


@needs_systemd_analyze
def test_its_exposure_is_below_4_of_10(tmp_path: Path) -> None:
    unit = tmp_path / "mavboat.service"
    unit.write_text(unit_text(SCRIPTS), encoding="utf-8")
    code, said = analyze("security", "--offline=true", "--threshold=40", "--no-pager", str(unit))
    assert code == 0, said


def test_the_files_of_the_example_lie_in_folders_that_the_unit_makes() -> None:
    settings = service()
    assert settings["WorkingDirectory"] == f"/run/{settings['RuntimeDirectory']}" == str(RUNTIME_DIRECTORY)
    assert settings["Environment"] == f"LG_WD={settings['WorkingDirectory']}"
    assert load_config(BOAT).storage.folder == f"/var/lib/{settings['StateDirectory']}"


def test_the_module_that_root_runs_is_not_looked_for_in_the_users_folder() -> None:
    assert " -I -m companion.app.motors_off " in service()["ExecStopPost"]


# As its own user, who may read all files here, as on a Pi, where they lie in /opt, but write only his own

AS_ITS_USER = (
    "setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups",
    "--inh-caps=-all,+dac_read_search", "--ambient-caps=-all,+dac_read_search",
)  # fmt: skip
needs_root = pytest.mark.skipif(
    os.geteuid() != 0 or shutil.which("setpriv") is None, reason="only root may become another user"
)


@pytest.fixture
def folder() -> Iterator[Path]:
    """Empty, and the unit's user's own; what lies beside it, he may read."""
    with tempfile.TemporaryDirectory() as place:
        Path(place).chmod(0o755)
        folder = Path(place) / "run"
        folder.mkdir()
        os.chown(folder, NOBODY, NOBODY)
        yield folder


def environment(folder: Path) -> dict[str, str]:
    """The unit's, with its folder standing for /run/mavboat."""
    name, _, value = service()["Environment"].partition("=")
    return {**os.environ, name: value.replace("/run/mavboat", str(folder))}


@needs_root
def test_lgpio_loads_for_the_units_user_wherever_he_is(folder: Path) -> None:
    loads = [*AS_ITS_USER, sys.executable, "-c", "import lgpio"]
    subprocess.run(loads, cwd="/", env=environment(folder), check=True, timeout=JOB_S)


@needs_root
@pytest.mark.realtime
def test_a_folder_that_is_not_the_users_is_named(run_program: RunProgram, folder: Path) -> None:
    boat = folder.parent / "boat.toml"
    boat.write_text(LISTENING.replace('"state"', '""'), encoding="utf-8")
    command = ["env", "-u", "LG_WD", "-C", "/", *AS_ITS_USER, str(SCRIPTS / "boat-companion"), "run"]
    program = run_program(*command, "--config", str(boat))
    why = "Motors: L298N: the pins cannot be opened: lgpio cannot write to /; "
    program.wait_for(f"WARNING {why}", stream="err")
    program.send(signal.SIGTERM)
    assert program.wait(JOB_S).code == 0


@needs_root
@pytest.mark.realtime
def test_the_program_runs_as_its_own_user_in_an_empty_folder(run_program: RunProgram, folder: Path) -> None:
    boat = folder.parent / "boat.toml"
    boat.write_text(LISTENING.replace('"state"', f'"{folder}/state"'), encoding="utf-8")
    command = ["env", "-C", str(folder), *AS_ITS_USER, str(SCRIPTS / "boat-companion"), "run"]
    program = run_program(*command, "--config", str(boat), environment={**environment(folder), **MOCK_PINS})
    program.wait_for("listening on tcpin:", stream="err")
    program.send(signal.SIGTERM)
    ended = program.wait(JOB_S)
    assert ended.code == 0, ended
    assert (folder / "state").stat().st_uid == NOBODY
