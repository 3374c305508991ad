"""`boat-sitl fit`: the emulator of an owner's boat, from the logs of its voyages."""

import math
from pathlib import Path
from typing import Annotated

import numpy as np
from rich.console import Console
from rich.table import Column, Table

from companion.cli.command_line import Argument, Option, echo
from companion.cli.output_file import write_text
from companion.core.errors import UsageError
from mission_tools.cli.arguments import position
from mission_tools.mission.plan_file import save_mission
from sitl.scenarios.scenario import load_scenario
from sitl.twin.boat_file import boat_text, fitted_entries, own_settings, scaled_base
from sitl.twin.fit import fit_boat
from sitl.twin.manoeuvres import trial_mission
from sitl.twin.model import KEYS
from sitl.twin.response import stated_figures
from sitl.twin.voyage import read_voyage

OUT = Path("out/my_boat.toml")
_FITTED_SHARE = 0.85  # of the first voyage; the rest checks it


def fit(
    log: Annotated[Path | None, Argument(metavar="LOG", help="a voyage's log, as 00012.bin")] = None,
    also: Annotated[list[Path] | None, Option(metavar="LOG", help="a further one; can be repeated")] = None,
    base: Annotated[
        str, Option(metavar="BOAT", help="to begin with: lake, kit, catamaran, pool, or a .toml file")
    ] = "lake",
    mass: Annotated[float | None, Option(metavar="KG", least=0.01, help="afloat [the base boat's]")] = None,
    apart: Annotated[float | None, Option(metavar="M", least=0.01, help="shafts [the base boat's]")] = None,
    out: Annotated[Path, Option("--out", "-o", metavar="FILE.toml", help="the boat")] = OUT,
    png: Annotated[Path | None, Option(metavar="FILE", help="draw measured against simulated")] = None,
    voyage: Annotated[
        Path | None, Option(metavar="FILE.plan", help="write the voyage to sail, and end")
    ] = None,
    start: Annotated[str | None, Option(metavar="LAT,LON", help="where that voyage begins")] = None,
    heading: Annotated[float, Option(metavar="DEG", help="of its straight legs")] = 0.0,
) -> None:
    """Fit a boat to its voyages, and write it as a boat for the emulator.

    Sail the voyage of --voyage with LOG_FILE_RATEMAX 50. Drag, inertia, motors and their differences are
    found with a deviation each. What a voyage does not tell stays the base boat's, and a comment says which
    manoeuvre would tell it.

    Example:  boat-sitl fit out/evening.bin --mass 8.2 --apart 0.31 --out out/my_boat.toml
    """
    path = base if not base.endswith(".toml") else str(Path(base).resolve())
    scenario = load_scenario("open", [f"boat.model={path}"])
    if scenario.thrusters.rudder is not None or scenario.thrusters.apart_m == 0.0:
        raise UsageError(f"--base {base}: a boat that steers by two motors is expected")
    if voyage is not None:
        place = position("--start", start)
        if place is None:
            raise UsageError("--start is missing: expected LAT,LON of open water, where the voyage begins")
        save_mission(trial_mission(place, scenario.vehicle.speed.cruise_m_s, math.radians(heading)), voyage)
        echo(f"written: {voyage}: about ten minutes")
        return
    if log is None:
        raise UsageError("LOG is missing: expected the log of a voyage, or --voyage FILE.plan")
    logs, base_boat = [log, *(also or ())], scaled_base(scenario, mass, apart)
    voyages = [read_voyage(one, scenario.battery.resistance_ohm) for one in logs]
    fitted_s = _FITTED_SHARE * voyages[0].duration_s
    found = fit_boat(base_boat, [voyages[0].part(0.0, fitted_s), *voyages[1:]])
    entries = {**fitted_entries(found), **own_settings(scenario, voyages[0].parameters)}
    figures = stated_figures(found)
    head = [f"# Fitted by boat-sitl fit to {', '.join(one.name for one in logs)}, over {base}."]
    head += [f"# {name}: {value:.3g}, one deviation {deviation:.2g}" for name, value, deviation in figures]
    write_text(out, boat_text(base_boat.boat_file.read_text(encoding="utf-8"), "\n".join(head), entries))
    load_scenario("open", [f"boat.model={out.resolve()}"])
    if png is not None:
        # matplotlib takes a second to import
        from sitl.twin.picture import draw_fit  # noqa: PLC0415

        draw_fit(found, voyages[0].part(fitted_s, voyages[0].duration_s), png)
    console = Console(highlight=False, soft_wrap=True)
    table = Table(Column(no_wrap=True), "of the base boat's", "deviation", "cannot be told: sail", box=None)
    deviations = np.sqrt(np.diag(found.covariance))
    for key, value, deviation, told in zip(found.keys, found.logs, deviations, found.told, strict=True):
        table.add_row(key, f"{math.exp(value):.3f}", f"{deviation:.1%}", "" if told else KEYS[key].told_by)
    for name, value, deviation in figures:
        table.add_row(name, f"{value:.3g}", f"{deviation / value:.1%}", "")
    console.print(table)
    console.print(f"written: {out}; gains for it: boat-sitl tune {out}")
