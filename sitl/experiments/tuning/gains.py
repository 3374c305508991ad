"""The gains that are tuned: their names as parameters, their values in a configuration, their file."""

from collections.abc import Mapping, Sequence
from random import Random
from typing import Any

from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from sitl.experiments.campaign.campaign import latin_hypercube

TUNED = ("heading.kp", "heading.ki", "heading.kd", "speed.kp", "speed.ki")
"""Fields of the boat's configuration."""

_FLOOR = {"heading.ki": 0.05, "speed.ki": 0.05}  # a gain that is 0 has a place to begin, too
_DIGITS = 3

Gains = dict[str, float]


def gains_of(config: BoatConfig) -> Gains:
    out = {}
    for path in TUNED:
        section, _, name = path.partition(".")
        out[path] = float(getattr(getattr(config, section), name))
    return out


def settings_of(gains: Mapping[str, float]) -> dict[str, Any]:
    """As a scenario's [vehicle.*]."""
    tree: dict[str, Any] = {}
    for path, value in gains.items():
        section, _, name = path.partition(".")
        tree.setdefault(section, {})[name] = value
    return {"vehicle": tree}


def drawn_around(centre: Mapping[str, float], reach: float, count: int, random: Random) -> list[Gains]:
    """So many sets of gains within a factor of reach of the centre: a Latin hypercube of their logarithms.

    They have few digits, so that the file says exactly what was sailed.
    """
    columns: dict[str, list[float]] = {}
    for path, value in centre.items():
        middle = max(value, _FLOOR.get(path, 0.0))
        shares = latin_hypercube(random, count)
        columns[path] = [float(f"{middle * reach ** (2.0 * share - 1.0):.{_DIGITS}g}") for share in shares]
    return [{path: values[row] for path, values in columns.items()} for row in range(count)]


def parameter_file(gains: Mapping[str, float], remarks: Sequence[str]) -> str:
    """One `NAME VALUE` a line, as the boat and the ground stations read them; remarks go before."""
    names = {row.path: row.name for row in reversed(ROWS) if row.path in gains}
    lines = [f"# {remark}" for remark in remarks]
    lines += [f"{names[path]} {value:g}" for path, value in gains.items()]
    return "\n".join(lines) + "\n"
