"""`boat-companion doctor` as it is called."""

import json
import os
from pathlib import Path

import pytest
from doctor_tree import PI_4, Tree

from companion.app.cli import run_program
from companion.app.doctor.accounts import check_own_groups, check_user
from companion.app.doctor.findings import Examined, Verdict
from companion.app.install.steps import apply_steps
from companion.app.install.target import Target
from companion.config.boat_config import BoatConfig

pytest_plugins = ("doctor_fixtures",)

BOAT = """
links = ["tcpin:0.0.0.0:5760"]
parts.motors.driver = "l298n"
parts.gnss = { driver = "nmea", port = "/dev/serial0" }
external.heading = 2
storage.folder = "/var/lib/mavboat"
"""
GROUP = "gpio:x:1:mavboat,skipper\ni2c:x:2:mavboat\ndialout:x:3:mavboat\nvideo:x:4:mavboat\n"
USERS = "mavboat:x:999:999::/:/bin/false\nskipper:x:1000:1000::/:/bin/sh\n"
SOUND = {
    "/etc/mavboat/boat.toml": BOAT,
    "/etc/passwd": USERS,
    "/etc/group": GROUP,
    "/etc/shadow": "",
    "/etc/gshadow": "",
    "/proc/device-tree/model": PI_4,
    "/sys/devices/platform/soc/soc:firmware/get_throttled": "0\n",
    "/sys/class/net/wlan0/operstate": "up\n",
    "/boot/firmware/config.txt": "enable_uart=1\n",
    "/boot/firmware/cmdline.txt": "console=tty1\n",
    "/dev/serial0": "",
    "/var/lib/mavboat/logs/x": "",
    "/usr/bin/pinctrl": "",
}


def run_json(root: Path, capsys: pytest.CaptureFixture[str], *more: str) -> tuple[int, dict[str, str]]:
    """Exit code, and the verdict of each check."""
    code = run_program(["doctor", "--json", "--root", str(root), *more])
    report = json.loads(capsys.readouterr().out)
    assert report["ok"] is (code == 0)
    return code, {row["check"]: row["verdict"] for row in report["findings"]}


def test_a_sound_boat(tree: Tree, capsys: pytest.CaptureFixture[str]) -> None:
    code, verdicts = run_json(tree(SOUND), capsys)
    assert code == 0
    assert "failed" not in verdicts.values()
    fine = {"computer", "supply", "disk", "clock", "network", "boat's user", "configuration", "boot settings"}
    assert {name for name, verdict in verdicts.items() if verdict == "fine"} >= fine | {
        "serial console",
        "devices",
    }


def test_what_fails_sets_the_exit_code_and_fix_mends_what_is_safe(
    tree: Tree, capsys: pytest.CaptureFixture[str]
) -> None:
    root = tree(
        {**SOUND, "/boot/firmware/config.txt": "", "/boot/firmware/cmdline.txt": "console=serial0,115200\n"}
    )
    code, verdicts = run_json(root, capsys)
    assert code == 1
    assert (verdicts["boot settings"], verdicts["serial console"]) == ("failed", "failed")
    assert run_program(["doctor", "--root", str(root), "--fix"]) == 1
    assert "done     write /boot/firmware/config.txt: with enable_uart=1" in capsys.readouterr().out
    code, verdicts = run_json(root, capsys)
    assert (code, verdicts["boot settings"], verdicts["serial console"]) == (0, "fine", "fine")


@pytest.mark.parametrize("text", [None, "links = 3", 'links = ["tcpin:0.0.0.0:5760"]'])
def test_a_configuration_that_cannot_be_used_is_a_finding(
    tree: Tree, capsys: pytest.CaptureFixture[str], text: str | None
) -> None:
    files = {**SOUND, "/etc/mavboat/boat.toml": text or ""}
    root = tree(files)
    if text is None:
        (root / "etc/mavboat/boat.toml").unlink()
    code, verdicts = run_json(root, capsys)
    assert (code, verdicts["configuration"]) == (1, "failed")


def examined(root: Path) -> Examined:
    return Examined(Target(root), BoatConfig())


def test_groups_of_the_boats_user(tree: Tree) -> None:
    assert check_user(examined(tree(SOUND))).verdict is Verdict.FINE
    lacking = check_user(
        examined(tree({**SOUND, "/etc/group": GROUP.replace("i2c:x:2:mavboat", "i2c:x:2:")}))
    )
    assert lacking.verdict is Verdict.FAILED
    assert len(lacking.fix) == 1
    assert check_user(examined(tree({**SOUND, "/etc/passwd": ""}))).verdict is Verdict.WARNING


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can change groups")
def test_groups_of_whoever_asks(tree: Tree) -> None:
    root = tree(SOUND)
    found = check_own_groups(examined(root), "skipper")
    assert (found.verdict, found.text) == (Verdict.WARNING, "skipper is not in i2c, dialout")
    apply_steps(found.fix, lambda _: None)
    assert check_own_groups(examined(root), "skipper").verdict is Verdict.FINE
    found.fix[0].undo()
    assert check_own_groups(examined(root), "skipper").text == found.text
    assert check_own_groups(examined(root), "root").verdict is Verdict.FINE
