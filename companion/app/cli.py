"""The commands of boat-companion, the program on the boat."""

import contextlib
import logging
from pathlib import Path
from typing import Annotated

import msgspec
import typer
from rich.console import Console
from rich.table import Table

from companion import __version__
from companion.app.calibrate.compass import calibrate_compass as run_compass_calibration
from companion.app.calibrate.escs import calibrate_escs as run_calibration
from companion.app.clock import SystemClock
from companion.app.composition import check_config, open_storage, run_boat
from companion.app.doctor.cli import doctor
from companion.app.init.cli import init
from companion.app.install.cli import install, uninstall
from companion.app.links_view import watch
from companion.app.restart import restart_program
from companion.app.shutdown import Shutdown
from companion.app.status_file import find_status, read_status
from companion.cli.busy_port import busy_port_explained
from companion.cli.command_line import program_app, run_app
from companion.config.boat_config import BoatConfig, load_config
from companion.config.parameter_page import parameter_page
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.config.parts import PulseOutputSetting
from companion.core.errors import BoatError
from companion.core.storage import MemoryStorage
from companion.hal.interfaces import PulseOutput
from companion.hal.pulses.opening import open_pulse_output

PROGRAM = "boat-companion"

app = program_app("The vehicle: drives the boat and speaks MAVLink to every ground station.")
app.command()(doctor)
app.command()(install)
app.command()(uninstall)

ConfigFile = Annotated[Path, typer.Option("--config", "-c", help="The boat's TOML file.")]

app.command()(init)


@app.command()
def run(
    config: ConfigFile,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Say more in the log.")] = False,
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


@app.command()
def check(config: ConfigFile) -> None:
    """Read a configuration and say what is wrong with it, without touching any hardware."""
    tree = load_config(config)
    check_config(tree)
    typer.echo(f"{config}: fine; links {', '.join(link.url for link in tree.link_settings)}")


@app.command()
def calibrate_compass(config: ConfigFile) -> None:
    """Find the iron near a magnetometer while you turn the boat; the boat's program must not run.

    Example:  boat-companion calibrate-compass --config /etc/mavboat/boat.toml
    """
    tree = load_config(config)
    with contextlib.closing(open_storage(tree.storage.folder)) as storage:
        run_compass_calibration(tree, storage, SystemClock(), typer.echo)


@app.command()
def calibrate_escs(config: ConfigFile) -> None:
    """Teach speed controllers the pulses of full throttle and stop, propellers off; asks before it sends.

    Example:  boat-companion calibrate-escs --config /etc/mavboat/boat.toml
    """
    tree = load_config(config)

    def open_output(setting: PulseOutputSetting) -> PulseOutput:
        return open_pulse_output(setting, tree.parts.pca9685)

    if not run_calibration(tree, open_output, input):
        typer.echo("not confirmed; nothing was sent")


@app.command()
def links(
    config: ConfigFile,
    as_json: Annotated[bool, typer.Option("--json", help="Print the figures once, as JSON.")] = False,
) -> None:
    """Show the running boat's links, second by second, until Ctrl-C.

    Example:  boat-companion links --config /etc/mavboat/boat.toml
    """
    path = find_status(load_config(config))
    if as_json:
        typer.echo(msgspec.json.format(msgspec.json.encode(read_status(path))).decode())
        return
    with contextlib.suppress(KeyboardInterrupt):
        watch(path, Console())


@app.command()
def params(
    markdown: Annotated[bool, typer.Option("--markdown", help="Print docs/parameters.md.")] = False,
) -> None:
    """List every parameter with its default, unit and meaning."""
    if markdown:
        typer.echo(parameter_page(), nl=False)
        return
    table = Table("name", "default", "unit", "meaning", box=None)
    parameters = Parameters(BoatConfig(), ROWS, MemoryStorage())
    for row in ROWS:
        table.add_row(row.name, f"{parameters.value(row):g}", row.unit, row.text)
    Console().print(table)


@app.command()
def version() -> None:
    """Print the version."""
    typer.echo(__version__)


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return run_app(app, PROGRAM, arguments, expected=(BoatError,))
