"""`install --page`: the shore page as a service, and what it may then do."""

from pathlib import Path

import pytest
from test_install import FILES_MADE, files, needs_passwd, root, snapshot

from companion.app.cli import run_program
from companion.app.doctor.accounts import check_page
from companion.app.doctor.findings import Examined
from companion.app.install.plan import PIN_FILE, shore_unit_text
from companion.app.install.target import Target
from companion.config.boat_config import load_config
from mission_tools.shore.command_line import read_arguments

__all__ = ("root",)

PAGE_FILES = {
    "etc/systemd/system/mavboat-shore.service",
    "etc/systemd/system/multi-user.target.wants/mavboat-shore.service",
}


def install(root: Path, *options: str) -> int:
    return run_program(["install", "--root", str(root), *options])


@needs_passwd
def test_the_page_is_installed_only_if_asked_for_and_stays(
    root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = files(root)
    assert install(root) == 0
    assert not files(root) & PAGE_FILES
    assert install(root, "--page") == 0
    assert files(root) - before - {"etc/subuid", "etc/subgid"} == FILES_MADE | PAGE_FILES
    assert "Set the page's PIN: sudo -u mavboat" in capsys.readouterr().out
    assert {(root / name).stat().st_uid for name in ("etc/mavboat", "etc/mavboat/boat.toml")} == {0}

    after = snapshot(root)
    assert install(root) == 0
    assert snapshot(root) == after, "a later installation takes the page away"
    assert run_program(["uninstall", "--root", str(root)]) == 0
    assert not files(root) & PAGE_FILES


@needs_passwd
def test_the_map_is_an_option_and_stays(root: Path, tmp_path: Path) -> None:
    water = tmp_path / "pond.geojson"
    water.write_text("{}", encoding="utf-8")
    assert install(root, "--page", "--page-map", str(water)) == 0
    assert (root / "etc/mavboat/map.geojson").read_text("utf-8") == "{}"
    unit = (root / "etc/systemd/system/mavboat-shore.service").read_text("utf-8")
    assert " --map /etc/mavboat/map.geojson\n" in unit
    after = snapshot(root)
    assert install(root, "--page") == 0
    assert snapshot(root) == after


def test_a_page_that_could_not_start_is_not_installed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "boat-shore"
    program.write_text("#!/bin/sh\necho \"boat-shore: needs the extra 'web'\" >&2\nexit 2\n", "utf-8")
    program.chmod(0o755)
    options = ["install", "--programs", str(tmp_path), "--dry-run"]
    assert run_program([*options, "--page"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    line = f"boat-companion: --page: {program} --version: boat-shore: needs the extra 'web'\n"
    assert said.err == line
    program.write_text("#!/bin/sh\necho 0.1.0\n", "utf-8")
    assert run_program([*options, "--page"]) == 0


def test_the_unit_starts_the_page_with_options_that_it_has() -> None:
    unit = shore_unit_text(Path("/opt/mavboat/.venv/bin"), has_map=True)
    (line,) = [one for one in unit.splitlines() if one.startswith("ExecStart=")]
    program, *arguments = line.removeprefix("ExecStart=").split()
    assert program == "/opt/mavboat/.venv/bin/boat-shore"
    given = read_arguments(arguments)
    assert (given.listen, given.connect) == ("0.0.0.0:80", "tcp:127.0.0.1:5760")
    assert (given.boat, given.pin_file) == ("/etc/mavboat/boat.toml", PIN_FILE)
    assert "$" not in unit


@needs_passwd
def test_the_doctor_misses_a_pin_a_link_and_the_start(root: Path) -> None:
    def told() -> list[str]:
        examined = Examined(Target(root), load_config(root / "etc/mavboat/boat.toml"))
        return [f"{one.verdict}: {one.text}" for one in check_page(examined)]

    assert install(root) == 0
    assert told() == []
    assert install(root, "--page") == 0
    assert told() == ["warning: no PIN is set: it only shows"]
    (root / str(PIN_FILE).lstrip("/")).touch()
    assert told() == ["fine: starts with the computer, and has a PIN"]
    file = root / "etc/mavboat/boat.toml"
    file.write_text(file.read_text("utf-8").replace("tcpin:127.0.0.1:5760", "tcpin:127.0.0.1:5761"), "utf-8")
    assert told() == ["failed: the boat has no link for it at TCP port 5760"]
    (root / "etc/systemd/system/multi-user.target.wants/mavboat-shore.service").unlink()
    assert told() == ["warning: does not start with the computer"]
