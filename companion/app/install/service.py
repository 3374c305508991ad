"""Steps that tell systemd and udev of what was installed."""

from pathlib import Path

from companion.app.install.steps import InstallStep
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


def enabled_step(target: Target, *, is_wanted: bool, unit: str = UNIT) -> InstallStep:
    """Let a unit start with the machine, or not."""
    root = [] if target.is_this_machine else ["--root", str(target.root)]

    def switch(is_on: bool) -> None:
        now = ["--now"] if target.is_this_machine and not is_on else []
        target.run("systemctl", *root, "enable" if is_on else "disable", *now, unit)

    return InstallStep(
        f"start {unit} with the machine" if is_wanted else f"stop {unit}, and start it no more",
        lambda: target.path(_WANTS / unit).is_symlink() == is_wanted,
        lambda: switch(is_wanted),
        lambda: switch(not is_wanted),
    )


def compiled_step(target: Target, programs: Path) -> InstallStep:
    """Compile what the boat imports, as root: its user may not write beside the sources, and would compile
    them again at every start. Drivers' libraries, which are imported late, are named. It is always repeated,
    which takes no time if nothing is new; a read-only environment stays as it is.
    """
    return InstallStep(
        "compile what the boat imports",
        lambda: False,
        lambda: target.run(str(programs / "python"), "-I", "-c", _COMPILE),
        lambda: None,  # Python ignores compiled files without their sources
    )


def reloaded_step(target: Target) -> InstallStep:
    """Have the running systemd, journal and udev read what was written. It is always repeated."""

    def reload() -> None:
        target.run("systemctl", "daemon-reload")
        target.run("systemctl", "try-restart", "systemd-journald.service")
        if not _UDEV.exists():
            return  # a container
        target.run("udevadm", "control", "--reload")
        for subsystem in ("tty", "pwm", "gpio", "i2c-dev"):
            target.run("udevadm", "trigger", "--subsystem-match", subsystem)

    text = "let systemd, the journal and udev read the new files"
    return InstallStep(text, lambda: False, reload, lambda: None)  # the files are restored, and read later
