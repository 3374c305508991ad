"""Arguments that several commands share."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from companion.cli.command_line import Argument, Option
from companion.core.geo import LatLon
from mission_tools.cli.arguments import position
from sitl.scenarios.scenario import load_scenario
from sitl.world.sampling import MOST_SEED
from sitl.world.scenario import Scenario

Source = Annotated[
    str,
    Argument(metavar="SCENARIO", help="lake, pool, open, random, bench_boat, a .toml file or a .geojson map"),
]
Settings = Annotated[
    list[str] | None,
    Option("--set", metavar="KEY=VALUE", help="any value of the scenario, as environment.current_m_s=0.5"),
]
Case = Annotated[str | None, Option(metavar="N", help="one of the scenario's cases")]
Seed = Annotated[
    int | None,
    Option(least=-MOST_SEED, most=MOST_SEED, help="of every random number in the run [the scenario's]"),
]
Workers = Annotated[int | None, Option(least=1, most=1024, metavar="N", help="processes [all cores]")]
StartAt = Annotated[str | None, Option("--start", metavar="LAT,LON", help="where the boat lies at first")]
Csv = Annotated[
    Path | None, Option(metavar="FILE", help="write the true trajectory, one row a tenth of a second")
]


def scenario_from(
    source: str,
    settings: Sequence[str] | None,
    case: str | None,
    seed: int | None,
    start: str | None,
    home: LatLon | None = None,
) -> Scenario:
    """The scenario that the command line names. home: where a bare map's boat lies if nothing else says so.

    Raises ConfigError, MissionToolsError: it cannot be used; names file and key.
    """
    overrides = list(settings or ())
    if seed is not None:
        overrides.append(f"seed={seed}")
    place = position("--start", start) or (home if Path(source).suffix in {".geojson", ".json"} else None)
    if place is not None:
        overrides.append(f"boat.start={{lat_deg={place.lat_deg!r}, lon_deg={place.lon_deg!r}}}")
    return load_scenario(source, overrides, case)


def with_json_file_option(arguments: Sequence[str]) -> list[str]:
    """`--json FILE.json` names a file and becomes `--json-file FILE.json`; a bare `--json` stays."""
    told = list(arguments)
    for index, argument in enumerate(arguments[:-1]):
        if argument == "--json" and arguments[index + 1].endswith(".json"):
            told[index] = "--json-file"
    return told
