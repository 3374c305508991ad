"""The commands of docs/first-day.md, in their order, on a Debian with its own systemd and no parts of a boat.

The environment of the tests stands for /opt/mavboat/.venv. Everything is done as root, without sudo.
"""

import json
import re
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from systemd_machine import PROJECT, SystemdMachine, why_not

from companion.app.init.presets import preset_text

REASON = why_not()
pytestmark = [pytest.mark.realtime, pytest.mark.skipif(bool(REASON), reason=REASON)]

PAGE = (PROJECT / "docs" / "first-day.md").read_text(encoding="utf-8")
BOOT_FILES = """
mkdir -p $root/boot/firmware
echo dtparam=audio=on > $root/boot/firmware/config.txt
echo 'console=serial0,115200 console=tty1 root=PARTUUID=1' > $root/boot/firmware/cmdline.txt
"""
NOT_HERE = re.compile(r"^(nano|sudo reboot|sudo journalctl)|--motors")  # an editor, a wait, a question
ASKING = "boat-companion init --detect --output boat.toml"
WITH_ANSWERS = "boat-companion init --preset lake --yes --output boat.toml"
SET_UP = ["boat's user", "configuration", "boot settings", "serial console"]


def commands(heading: str) -> list[str]:
    """The commands of a section's first block."""
    block = PAGE.partition(f"\n## {heading}")[2].partition("```sh\n")[2].partition("```")[0]
    lines = [line.partition("  #")[0].strip() for line in block.splitlines()]
    typed = [WITH_ANSWERS if line == ASKING else line for line in lines if not NOT_HERE.search(line)]
    assert WITH_ANSWERS in typed or ASKING not in block
    return [line.removeprefix("sudo ") for line in typed]


class Visitor:
    """Somebody who types the commands."""

    def __init__(self, machine: SystemdMachine) -> None:
        self._machine = machine

    def types(self, command: str) -> str:
        """Run a command in the home folder; its output and exit code."""
        setting = f"export PATH={Path(sys.executable).parent}:$PATH; cd /root; B=$(command -v boat-companion)"
        return self._machine.run("bash", "-c", f"{setting}; {command} 2>&1; echo exit code $?")


@pytest.fixture
def visitor(tmp_path: Path) -> Iterator[Visitor]:
    machine = SystemdMachine(tmp_path / "machine", BOOT_FILES)
    with closing(machine):
        machine.until(machine.is_up, "booted")
        yield Visitor(machine)


def test_the_steps_of_the_page_leave_a_boat_that_lacks_only_its_parts(visitor: Visitor) -> None:
    steps = commands("4. Configure") + commands("5. First checks")
    assert len(steps) >= 8
    for step in steps:
        said = visitor.types(step)
        if "doctor" in step:
            assert re.search(r"exit code [01]\n$", said), f"{step}: {said}"
        else:
            assert said.endswith("exit code 0\n"), f"{step}: {said}"
    assert visitor.types("systemctl is-active mavboat").startswith("active\n")
    assert preset_text("lake") in visitor.types("cat /etc/mavboat/boat.toml")
    assert visitor.types("systemctl is-enabled mavboat").startswith("enabled\n")
    report = json.loads(visitor.types("boat-companion doctor --json").rpartition("exit code")[0])
    verdicts = {one["check"]: one["verdict"] for one in report["findings"]}
    assert [verdicts[check] for check in SET_UP] == ["fine"] * len(SET_UP)
    assert "enable_uart=1" in visitor.types("cat /boot/firmware/config.txt")
    assert "serial0" not in visitor.types("cat /boot/firmware/cmdline.txt")
