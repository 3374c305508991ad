"""Steps that tell systemd and udev of what was installed."""

from pathlib import Path

from companion.app.install.target import Target

UNIT = "mavboat.service"
_UDEV = Path("/run/udev/control")
_COMPILE = """
import compileall, importlib.util, pathlib, companion.app.cli
for name in ("gpiozero", "lgpio", "smbus2", "colorzero"):
    if spec := importlib.util.find_spec(name):
        origin = pathlib.Path(spec.origin)
        if origin.name == "__init__.py":
            compileall.compile_dir(origin.parent, quiet=2)
        else:
            compileall.compile_file(origin, quiet=2)
"""
_WANTS = Path("/etc/systemd/system/multi-user.target.wants")


class Enabled:
    """The unit starts with the machine, or does not."""

    def __init__(self, target: Target, *, is_wanted: bool, unit: str = UNIT) -> None:
        self._target = target
        self._unit = unit
        self._is_wanted = is_wanted

    def describe(self) -> str:
        """What it does."""
        unit = self._unit
        return f"start {unit} with the machine" if self._is_wanted else f"stop {unit}, and start it no more"

    def is_done(self) -> bool:
        """Whether the link that enables it is there, or gone."""
        return self._target.path(_WANTS / self._unit).is_symlink() == self._is_wanted

    def apply(self) -> None:
        """Enable or disable it."""
        self._switch(self._is_wanted)

    def undo(self) -> None:
        """As it was."""
        self._switch(not self._is_wanted)

    def _switch(self, is_wanted: bool) -> None:
        target = self._target
        root = [] if target.is_this_machine else ["--root", str(target.root)]
        now = ["--now"] if target.is_this_machine and not is_wanted else []
        target.run("systemctl", *root, "enable" if is_wanted else "disable", *now, self._unit)


class Compiled:
    """What the boat imports is compiled by root: its user may not write beside the sources, and would compile
    them again at every start. Drivers' libraries, which are imported late, are named.
    """

    def __init__(self, target: Target, programs: Path) -> None:
        self._target = target
        self._programs = programs

    def describe(self) -> str:
        """What it does."""
        return "compile what the boat imports"

    def is_done(self) -> bool:
        """It is always repeated, which takes no time if nothing is new."""
        return False

    def apply(self) -> None:
        """Import the program, and compile the libraries; a read-only environment stays as it is."""
        self._target.run(str(self._programs / "python"), "-I", "-c", _COMPILE)

    def undo(self) -> None:
        """Nothing: Python ignores compiled files without their sources."""


class Reloaded:
    """The running systemd, journal and udev read what was written."""

    def __init__(self, target: Target) -> None:
        self._target = target

    def describe(self) -> str:
        """What it does."""
        return "let systemd, the journal and udev read the new files"

    def is_done(self) -> bool:
        """It is always repeated."""
        return False

    def apply(self) -> None:
        """Have the files read."""
        run = self._target.run
        run("systemctl", "daemon-reload")
        run("systemctl", "try-restart", "systemd-journald.service")
        if not _UDEV.exists():
            return  # a container
        run("udevadm", "control", "--reload")
        for subsystem in ("tty", "pwm", "gpio", "i2c-dev"):
            run("udevadm", "trigger", "--subsystem-match", subsystem)

    def undo(self) -> None:
        """Nothing: the files are restored after this, and read at the next start."""
