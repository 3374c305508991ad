"""`boat-companion install` and `uninstall` on the root folder of another system."""

import os
import re
import shutil
import stat
from pathlib import Path
from typing import Any

import pytest

from companion.app.cli import run_program
from companion.app.init.presets import preset_text
from companion.app.install.plan import (
    GROUPS,
    PROGRAMS,
    install_steps,
    uninstall_steps,
)
from companion.app.install.steps import InstallStep
from companion.app.install.target import InstallError, Target
from companion.config.boat_config import load_config

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
def test_a_configuration_is_checked_and_copied_but_never_over_the_owners(root: Path, tmp_path: Path) -> None:
    own = tmp_path / "own.toml"
    own.write_text('links = ["tcpin:0.0.0.0:5760"]\nparts.motors.driver = "l298n"\n', encoding="utf-8")
    assert run_program(["install", "--root", str(root), "--config", str(own)]) == 2, "no position, no heading"
    own.write_text(own.read_text() + "external = { position = 2, heading = 2 }\n", encoding="utf-8")
    assert run_program(["install", "--root", str(root), "--config", str(own)]) == 0
    installed = root / "etc/mavboat/boat.toml"
    assert installed.read_text() == own.read_text()
    assert run_program(["install", "--root", str(root)]) == 0
    assert installed.read_text() == own.read_text()


@needs_passwd
@pytest.mark.parametrize("number", [0, len(ALL_STEPS) // 2, len(ALL_STEPS) - 1])
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

    monkeypatch.setattr("companion.app.install.cli.install_steps", patched)
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
