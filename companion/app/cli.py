"""The commands of boat-companion, the program on the boat."""

import contextlib
import logging
from typing import Annotated

from msgspec import structs

from companion import __version__
from companion.app.calibrate import calibrate_compass as run_compass_calibration
from companion.app.calibrate import calibrate_escs as run_calibration
from companion.app.composition import check_config, open_storage, run_boat
from companion.app.process import Shutdown, restart_program
from companion.app.runner import SystemClock
from companion.cli.command_line import ConfigFile, Option, Program, echo
from companion.cli.program_end import busy_port_explained
from companion.config.actuators import PulseOutputSetting
from companion.config.boat_config import load_config
from companion.core.errors import BoatError
from companion.hal.interfaces import PulseOutput
from companion.hal.pulses.opening import open_pulse_output

PROGRAM = "boat-companion"


def run(
    config: ConfigFile,
    verbose: Annotated[bool, Option("--verbose", "-v", help="Say more in the log.")] = False,
) -> None:
    """Run the boat until Ctrl-C or SIGTERM. The motors are off before the first and after the last tick.

    Example:  boat-companion run --config /etc/mavboat/boat.toml
    """
    logging.basicConfig(
        level=logging.DEBUG if verbose else logging.INFO, format="%(asctime)s %(levelname)s %(message)s"
    )
    shutdown = Shutdown()
    shutdown.install()
    with busy_port_explained(f"change links in {config}"):
        boat = run_boat(load_config(config), shutdown)
    if boat.wants_restart and not shutdown():
        restart_program()


def check(config: ConfigFile) -> None:
    """Read a configuration and say what is wrong with it, without touching any hardware."""
    tree = load_config(config)
    check_config(tree)
    parts = structs.asdict(tree.parts) | {"rc": tree.rc}
    drivers = {name: getattr(part, "driver", "none") for name, part in parts.items()}
    fitted = ", ".join(f"{name} {driver}" for name, driver in drivers.items() if driver != "none")
    echo(f"{config}: fine; parts {fitted}; links {', '.join(link.url for link in tree.link_settings)}")


def calibrate_compass(config: ConfigFile) -> None:
    """Find the iron near a magnetometer while you turn the boat; the boat's program must not run.

    Example:  boat-companion calibrate-compass --config /etc/mavboat/boat.toml
    """
    tree = load_config(config)
    with contextlib.closing(open_storage(tree.storage.folder)) as storage:
        run_compass_calibration(tree, storage, SystemClock(), echo)


def calibrate_escs(config: ConfigFile) -> None:
    """Teach speed controllers the pulses of full throttle and stop, propellers off; asks before it sends.

    Example:  boat-companion calibrate-escs --config /etc/mavboat/boat.toml
    """
    tree = load_config(config)

    def open_output(setting: PulseOutputSetting) -> PulseOutput:
        return open_pulse_output(setting, tree.parts.pca9685)

    if not run_calibration(tree, open_output, input):
        echo("not confirmed; nothing was sent")


def version() -> None:
    """Print the version of the installed program."""
    echo(__version__)


program = Program(
    PROGRAM,
    "The vehicle: drives the boat and speaks MAVLink to every ground station.",
    (
        "companion.app.init.questions:init",
        run,
        check,
        "companion.app.doctor.cli:doctor",
        "companion.app.install.cli:install",
        "companion.app.install.cli:uninstall",
        calibrate_compass,
        calibrate_escs,
        "companion.app.links:links",
        "companion.app.params:params",
        version,
    ),
    expected=(BoatError,),
)


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return program.run(arguments)
