"""The gains that are tuned: their names as parameters, their values in a configuration, their file."""

import math
from collections.abc import Mapping, Sequence
from random import Random
from typing import Any

from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS

TUNED = ("heading.kp", "heading.ki", "heading.kd", "speed.kp", "speed.ki")
"""Fields of the boat's configuration."""

_FLOOR = {"heading.ki": 0.05, "speed.ki": 0.05}  # a gain that is 0 has a place to begin, too
_DIGITS = 3

Gains = dict[str, float]


def gains_of(config: BoatConfig) -> Gains:
    """What a boat is configured with."""
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
        order = list(range(count))
        random.shuffle(order)
        middle = max(value, _FLOOR.get(path, 0.0))
        columns[path] = [
            _short(middle * math.exp(math.log(reach) * (2.0 * (stratum + random.random()) / count - 1.0)))
            for stratum in order
        ]
    return [{path: values[row] for path, values in columns.items()} for row in range(count)]


def parameter_file(gains: Mapping[str, float], remarks: Sequence[str]) -> str:
    """One `NAME VALUE` a line, as the boat and the ground stations read them; remarks go before."""
    names = {row.path: row.name for row in reversed(ROWS) if row.path in gains}
    lines = [f"# {remark}" for remark in remarks]
    lines += [f"{names[path]} {value:g}" for path, value in gains.items()]
    return "\n".join(lines) + "\n"


def _short(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
