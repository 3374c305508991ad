"""`boat-companion install` and `uninstall` on the root folder of another system."""

import os
import re
import shutil
import stat
from pathlib import Path
from typing import Any

import pytest

from companion.app.cli import run_program
from companion.app.doctor.accounts import check_page
from companion.app.doctor.findings import Examined
from companion.app.init.presets import preset_text
from companion.app.install.plan import (
    GROUPS,
    PIN_FILE,
    PROGRAMS,
    install_steps,
    shore_unit_text,
    uninstall_steps,
)
from companion.app.install.steps import InstallStep, apply_steps
from companion.app.install.target import InstallError, Target
from companion.config.boat_config import load_config
from mission_tools.shore.command_line import read_arguments

needs_passwd = pytest.mark.skipif(
    os.geteuid() != 0 or any(shutil.which(name) is None for name in ("useradd", "systemctl")),
    reason="only root can make accounts, with useradd; and systemctl enables the unit",
)
ROOT_LINE = "root:x:0:0:root:/root:/bin/bash\n"
GROUP = "root:x:0:\ndialout:x:20:\nvideo:x:44:skipper\n"
ALL_STEPS = install_steps(Target(Path("/image")), PROGRAMS, "", page_map="")
FILES_MADE = {
    "etc/mavboat/boat.toml",
    "etc/udev/rules.d/60-mavboat.rules",
    "etc/modules-load.d/mavboat.conf",
    "etc/systemd/journald.conf.d/mavboat.conf",
    "etc/systemd/system.conf.d/mavboat.conf",
    "etc/sysctl.d/90-mavboat.conf",
    "etc/systemd/system/mavboat.service",
    "etc/systemd/system/multi-user.target.wants/mavboat.service",
}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A system of a few files."""
    root = tmp_path / "root"
    for folder in ("etc/systemd/system", "etc/udev/rules.d", "var/lib", "run"):
        (root / folder).mkdir(parents=True)
    for name, text in {
        "passwd": ROOT_LINE,
        "group": GROUP,
        "shadow": "root:*:19000::::::\n",
        "gshadow": "",
    }.items():
        (root / "etc" / name).write_text(text, encoding="utf-8")
    return root


def snapshot(root: Path) -> dict[str, str]:
    """Every path with its mode and content, without the copies that useradd keeps."""
    found = {}
    for path in sorted(root.rglob("*")):
        name = str(path.relative_to(root))
        if name.endswith(("-", ".lock")):
            continue
        status = path.lstat()
        content = path.read_text(encoding="utf-8") if path.is_file() else ""
        found[name] = f"{stat.filemode(status.st_mode)} {status.st_uid}:{status.st_gid} {content}"
    return found


def files(root: Path) -> set[str]:
    return {name for name, what in snapshot(root).items() if what[0] in "-l"}


@needs_passwd
def test_everything_is_made_once(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = files(root)
    assert run_program(["install", "--root", str(root)]) == 0
    assert files(root) - before - {"etc/subuid", "etc/subgid"} == FILES_MADE
    (user,) = [line for line in (root / "etc/passwd").read_text().splitlines() if line.startswith("mavboat:")]
    assert user.endswith(":mavboat companion:/var/lib/mavboat:/usr/sbin/nologin")
    groups = Target(root).groups()
    assert [name for name in GROUPS if "mavboat" not in groups[name]] == []
    assert groups["video"] == {"skipper", "mavboat"}
    state = (root / "var/lib/mavboat").stat()
    assert (state.st_uid, state.st_gid) == Target(root).ids("mavboat") != (0, 0)
    assert load_config(root / "etc/mavboat/boat.toml").parts.motors.driver == "l298n"
    assert (root / "etc/mavboat/boat.toml").read_text(encoding="utf-8") == preset_text("lake")
    said = capsys.readouterr().out
    assert f"{PROGRAMS}/boat-companion is missing" in said

    after = snapshot(root)
    assert run_program(["install", "--root", str(root)]) == 0
    assert snapshot(root) == after
    assert "done" not in capsys.readouterr().out


@needs_passwd
@pytest.mark.parametrize("number", [0, len(ALL_STEPS) - 1])
def test_whatever_step_fails_the_system_is_as_before(
    root: Path, monkeypatch: pytest.MonkeyPatch, number: int, capsys: pytest.CaptureFixture[str]
) -> None:
    (root / "etc/subuid").touch()
    (root / "etc/subgid").touch()
    before = snapshot(root)

    def fail(step: InstallStep) -> None:
        raise InstallError("no space left")

    def patched(*arguments: Any) -> list[InstallStep]:  # noqa: ANN401
        made = install_steps(*arguments)
        monkeypatch.setattr(made[number], "apply", lambda: fail(made[number]))
        monkeypatch.setattr(made[number], "is_done", lambda: False)
        return made

    monkeypatch.setattr("companion.app.install.plan.install_steps", patched)
    assert run_program(["install", "--root", str(root), "--page"]) == 1
    assert "no space left" in capsys.readouterr().err
    assert snapshot(root) == before


@needs_passwd
def test_uninstalling_keeps_what_is_the_owners_unless_told_otherwise(root: Path) -> None:
    assert run_program(["install", "--root", str(root)]) == 0
    mission = root / "var/lib/mavboat/mission.json"
    mission.write_text("{}", encoding="utf-8")
    assert run_program(["uninstall", "--root", str(root)]) == 0
    assert files(root) & FILES_MADE == {"etc/mavboat/boat.toml"}
    assert mission.exists()
    assert "mavboat" in Target(root).users(), "its files would belong to nobody"
    assert run_program(["uninstall", "--root", str(root), "--purge"]) == 0
    assert files(root) & FILES_MADE == set()
    assert not mission.exists()
    assert "mavboat" not in Target(root).users()
    assert Target(root).groups()["video"] == {"skipper"}, "shared groups stay"
    assert "gpio" in Target(root).groups()
    assert all(step.is_done() for step in uninstall_steps(Target(root), purge=True))


@pytest.mark.parametrize("command", ["install", "uninstall"])
def test_a_dry_run_changes_nothing(root: Path, command: str, capsys: pytest.CaptureFixture[str]) -> None:
    before = snapshot(root)
    assert run_program([command, "--root", str(root), "--dry-run"]) == 0
    assert snapshot(root) == before
    if command == "install":
        assert "  to do    make the group gpio\n  to do    make the group i2c\n" in capsys.readouterr().out


@pytest.mark.parametrize("command", ["install", "uninstall"])
def test_a_system_without_systemd_is_refused_before_anything_is_done(
    root: Path, command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (root / "programs").mkdir()
    monkeypatch.setenv("PATH", str(root / "programs"))
    before = snapshot(root)
    assert run_program([command, "--root", str(root)]) == 2
    assert snapshot(root) == before
    said = capsys.readouterr()
    assert said.out == ""
    assert re.fullmatch(r"boat-companion: systemctl: not installed; .*\n", said.err)


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


def recorded(record: list[str], name: str, *, is_done: bool = False, fails: str = "") -> InstallStep:
    """A step that records its calls."""

    def call(verb: str) -> None:
        record.append(f"{verb} {name}")
        if verb == fails:
            raise OSError(f"{name} fails")

    return InstallStep(name, lambda: is_done, lambda: call("apply"), lambda: call("undo"))


def test_a_step_that_fails_has_the_steps_before_it_undone_last_first() -> None:
    record: list[str] = []
    said: list[str] = []
    steps = [
        recorded(record, "a"),
        recorded(record, "b", is_done=True),
        recorded(record, "c", fails="undo"),
        recorded(record, "d", fails="apply"),
        recorded(record, "e"),
    ]
    with pytest.raises(OSError, match="d fails"):
        apply_steps(steps, said.append)
    assert record == ["apply a", "apply c", "apply d", "undo c", "undo a"]
    assert said[-2:] == ["  NOT undone  c: c fails", "  undone   a"]
