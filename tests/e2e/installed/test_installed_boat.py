"""The boat installed into a Debian system and started by that system's own systemd, on mock pins.

The pins are files that outlive the program (tests/twins/pin_files.py). No part but the motors is fitted.
"""

import json
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from pathlib import Path

import pytest
from mavutil_station import MavutilStation
from programs import until
from systemd_machine import SystemdMachine, bound_folders, why_not
from twins.pin_files import PINCTRL, write_entry_point

from companion.config.actuators import MotorsPart
from companion.mavlink.dialect import dialect

REASON = why_not()
pytestmark = [pytest.mark.realtime, pytest.mark.skipif(bool(REASON), reason=REASON)]

UNIT = "mavboat.service"
PINS = MotorsPart()
ENABLES = (PINS.left_enable, PINS.right_enable)
MANUAL = 0
BOAT = """
links = ["tcpin:127.0.0.1:0"]
parts.motors.driver = "l298n"
external = { position = 2, heading = 2 }
arming.check = false
storage.folder = "/var/lib/mavboat"
"""
DROP_IN = """
[Service]
Environment=GPIOZERO_PIN_FACTORY=mock GPIOZERO_MOCK_PIN_CLASS=filepin PIN_FILES=/run/pins PYTHONPATH=/opt/pins
ReadWritePaths=/run/pins
# a checkout below /tmp, whose /tmp the unit does not share
BindReadOnlyPaths={bound}
# the drivers' libraries load in the unit's sandbox, too
ExecStartPre={python} -c "import lgpio, serial, smbus2"
"""
PREPARE = """
mkdir -m 777 $root/run/pins
mkdir -p $root/opt $root/usr/local/bin $root/etc/systemd/system/mavboat.service.d
cp -r {folder}/pins $root/opt/pins
cp {folder}/mock.conf $root/etc/systemd/system/mavboat.service.d/
cp {folder}/pinctrl $root/usr/local/bin/
"""
SCRIPTS = Path(sys.executable).parent
COMPANION = f"{sys.executable} -m companion"


class InstalledBoat:
    """The boat's unit on the running system."""

    def __init__(self, machine: SystemdMachine) -> None:
        self.machine = machine

    def show(self, name: str) -> str:
        """A property of the unit."""
        return self.machine.show(UNIT, name)[name]

    def journal(self) -> str:
        """Its lines."""
        return self.machine.run("journalctl", "--no-pager", "-o", "cat", "-u", UNIT)

    def wait_until(self, name: str, value: str) -> None:
        """Wait for a property of the unit."""
        self.machine.until(lambda: self.show(name) == value, f"{name}={value}")

    def is_driving(self) -> bool:
        """Whether any motor gets current."""
        levels = self.machine.run("cat", *(f"/run/pins/GPIO{pin}" for pin in ENABLES)).split()
        return any(float(level) > 0.0 for level in levels)

    def was_driving(self) -> list[bool]:
        """Whether a motor got current before each call of pinctrl."""
        calls = self.machine.run("cat", "/run/pins/pinctrl").splitlines()
        pins = {tuple(re.findall(r"(\d+)=", call)) for call in calls}
        assert pins <= {tuple(map(str, ENABLES))}
        return [any(map(float, re.findall(r"=([\d.]+)", call))) for call in calls]

    def station(self) -> MavutilStation:
        """Connect to its port, which it chose at its latest start."""
        return MavutilStation(int(re.findall(r"tcpin:127\.0\.0\.1:(\d+)", self.journal())[-1]))

    def drive(self, station: MavutilStation) -> None:
        """Arm by hand over MAVLink and push the stick, until a motor turns."""
        assert station.enter(MANUAL) == dialect.MAV_RESULT_ACCEPTED
        assert station.arm() == dialect.MAV_RESULT_ACCEPTED

        def push() -> bool:
            station.heartbeat()
            station.mav.rc_channels_override_send(1, 1, 1500, 0, 1900, 0, 0, 0, 0, 0)
            return self.is_driving()

        until(push)

    def die_driving(self, number: str) -> None:
        """Drive, send the program a signal, and wait until systemd has started it again."""
        restarts = int(self.show("NRestarts"))
        with closing(self.station()) as station:
            self.drive(station)
            self.machine.run("sh", "-c", f"kill -{number} {self.show('MainPID')}", check=True)
            self.wait_until("NRestarts", str(restarts + 1))
        self.wait_until("ActiveState", "active")


@pytest.fixture
def prepared(tmp_path: Path) -> str:
    """Shell lines that put mock pins, a pinctrl and the boat's file into the system."""
    write_entry_point(tmp_path / "pins")
    (tmp_path / "boat.toml").write_text(BOAT, encoding="utf-8")
    (tmp_path / "mock.conf").write_text(
        DROP_IN.format(python=sys.executable, bound=" ".join(bound_folders())), encoding="utf-8"
    )
    (tmp_path / "pinctrl").write_text(PINCTRL.format(folder="/run/pins"), encoding="utf-8")
    (tmp_path / "pinctrl").chmod(0o755)
    return PREPARE.format(folder=tmp_path)


@pytest.fixture
def start_machine(tmp_path: Path) -> Iterator[Callable[[str], SystemdMachine]]:
    """Starts a system that was prepared by shell lines; it is ended afterwards."""
    with ExitStack() as ending:

        def start(prepare: str) -> SystemdMachine:
            machine = SystemdMachine(tmp_path / "machine", prepare)
            ending.callback(machine.close)
            machine.until(machine.is_up, "booted")
            return machine

        yield start


def test_it_starts_as_its_own_user_and_comes_back_with_its_motors_off_however_it_ends(
    start_machine: Callable[[str], SystemdMachine], prepared: str, tmp_path: Path
) -> None:
    install = f"{COMPANION} install --root $root --config {tmp_path}/boat.toml --programs {SCRIPTS}"
    boat = InstalledBoat(start_machine(f"{prepared}\n{install}"))
    boat.wait_until("ActiveState", "active")
    assert boat.show("StatusText") == "HOLD, disarmed"
    process = f"/proc/{boat.show('MainPID')}"
    assert boat.machine.run("stat", "-c", "%U", process) == "mavboat\n"
    niceness = boat.machine.run("cat", f"{process}/stat").rpartition(")")[2].split()[16]  # proc(5)
    assert niceness == "-10"

    boat.die_driving("KILL")
    assert boat.was_driving() == [True]
    boat.die_driving("SEGV")
    assert boat.was_driving() == [True] * 2
    boat.die_driving("STOP")
    assert boat.was_driving() == [True] * 3
    journal = boat.machine.run("journalctl", "--no-pager", "-o", "cat")
    assert "mavboat.service: Watchdog timeout" in journal

    pid = boat.show("MainPID")
    with closing(boat.station()) as station:
        assert station.command(dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == dialect.MAV_RESULT_ACCEPTED
        boat.wait_until("ActiveState", "reloading")
    boat.wait_until("ActiveState", "active")
    assert (boat.show("MainPID"), boat.show("NRestarts")) == (pid, "3"), "a restart in place is no end"

    with closing(boat.station()) as station:
        boat.drive(station)
        boat.wait_until("StatusText", "MANUAL, armed")
        boat.machine.run("systemctl", "stop", UNIT, check=True)
    assert boat.show("Result") == "success"
    assert boat.was_driving() == [True, True, True, False], "the program itself stops its motors"


def test_installed_on_the_running_system_it_runs_and_is_removed_again(
    start_machine: Callable[[str], SystemdMachine], prepared: str, tmp_path: Path
) -> None:
    kept = f"mkdir -p $root/etc/mavboat; cp {tmp_path}/boat.toml $root/etc/mavboat/"
    machine = start_machine(f"{prepared}\n{kept}")
    boat = InstalledBoat(machine)
    for word in ("done", "already"):
        said = machine.run(*COMPANION.split(), "install", check=True)
        assert re.search(f"{word} +write /etc/systemd/system/mavboat.service", said), said
    assert machine.run("cat", "/etc/mavboat/boat.toml") == BOAT, "the owner's configuration was overwritten"
    rules = machine.run("sh", "-c", "udevadm test /sys/class/mem/null 2>&1")
    assert "60-mavboat.rules" in rules
    complaints = [line for line in rules.splitlines() if "mavboat.rules:" in line]
    assert complaints == [], "udev does not understand its rules"
    machine.run("systemctl", "start", UNIT, check=True)
    assert boat.show("SubState") == "running"
    findings = json.loads(machine.run(*COMPANION.split(), "doctor", "--json"))["findings"]
    told = {one["check"]: (one["verdict"], one["text"]) for one in findings}
    assert told["service"] == ("fine", "starts with the computer, runs now: HOLD, disarmed")
    assert told["parts"] == ("skipped", "the running boat uses them")
    assert told["boat's user"][0] == told["folders"][0] == told["pinctrl"][0] == "fine"
    machine.run(*COMPANION.split(), "uninstall", check=True)
    assert boat.show("LoadState") == "not-found"
    assert machine.run("ls", "/etc/mavboat", "/var/lib/mavboat").split() == [
        "/etc/mavboat:", "boat.toml", "/var/lib/mavboat:", "files", "logs",
    ]  # fmt: skip
    machine.run(*COMPANION.split(), "uninstall", "--purge", check=True)
    assert machine.run("ls", "-d", "/etc/mavboat", "/var/lib/mavboat") == ""
    assert "mavboat" not in machine.run("cat", "/etc/passwd", "/etc/group")
