"""The tuning problem of one boat: the runs for a set of gains, and their cost.

The course has right angles, a sharp turn and a gentle one, on legs of ten waypoint radii, so that it suits
a boat of any size. It is run in still water and in currents of a quarter of the cruise speed. A run costs

    (RMS + ¼ largest + ½ overshoot) / waypoint radius + EFFORT × command travel per second

with cross-track errors of the current leg from when the boat moves; a run that is not completed costs FAILED.
Corners and currents cost something whatever the gains are, so gains are compared by the ratio of their cost
to that of the original gains, run by run, in the same current with the same seed: 0.9 is a tenth better.
"""

from collections.abc import Mapping, Sequence
from operator import attrgetter
from pathlib import Path
from random import Random
from typing import Any

from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.core.geo import LocalFrame, Point
from mission_tools.mission.plan_file import save_mission
from mission_tools.mission.route import mission_along
from sitl.experiments.campaign.campaign import latin_hypercube
from sitl.experiments.trial import Trial, TrialResult
from sitl.scenarios.layers import Layer, merge

FAILED = 10.0
EFFORT = 0.01
LEG_RADII = 10.0
_CORNERS = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 1.0), (1.3, 1.7), (2.3, 2.0))
_CURRENT_SHARE = 0.25
_CURRENTS_TO_DEG = (None, 90.0, 225.0)
TUNED = ("heading.kp", "heading.ki", "heading.kd", "speed.kp", "speed.ki")
"""Fields of the boat's configuration."""

_FLOOR = {"heading.ki": 0.05, "speed.ki": 0.05}  # a gain that is 0 has a place to begin, too
_DIGITS = 3

Gains = dict[str, float]


def gains_of(config: BoatConfig) -> Gains:
    return {path: float(attrgetter(path)(config)) for path in TUNED}


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


class TuningProblem:
    """The trials for sets of gains, and the costs of their results."""

    trials_per_seed = len(_CURRENTS_TO_DEG)

    def __init__(self, model: str, config: BoatConfig, frame: LocalFrame, folder: Path) -> None:
        """Write the course to a file in the folder."""
        self._model = model
        self._radius_m = config.guidance.waypoint_radius_m
        self._current_m_s = _CURRENT_SHARE * config.speed.cruise_m_s
        leg_m = LEG_RADII * self._radius_m
        points = [frame.to_global(Point(leg_m * north, leg_m * east)) for north, east in _CORNERS]
        self._course = folder / "course.waypoints"
        save_mission(mission_along(points), self._course)

    def trials(self, gains: Gains, seeds: range, first_number: int) -> list[Trial]:
        """Every current with every seed, seed by seed."""
        return [
            Trial(
                number=first_number + number,
                scenario="open",
                seed=seed,
                mission=str(self._course),
                settings=merge([Layer("", tree) for tree in (self._currents(to_deg), settings_of(gains))]),
                source="tune",
            )
            for number, (seed, to_deg) in enumerate(
                (seed, to_deg) for seed in seeds for to_deg in _CURRENTS_TO_DEG
            )
        ]

    def cost(self, result: TrialResult) -> float:
        names = ("kept_rms_m", "kept_max_m", "overshoot_m", "command_travel_per_s")
        values = [result.figures.get(name) for name in names]
        if result.ended != "completed" or not all(isinstance(value, float) for value in values):
            return FAILED
        rms_m, max_m, overshoot_m, travel = (float(value or 0.0) for value in values)
        return (rms_m + 0.25 * max_m + 0.5 * overshoot_m) / self._radius_m + EFFORT * travel

    def ratios(self, results: Sequence[TrialResult], of_first: Sequence[TrialResult]) -> list[float]:
        """Costs relative to the original gains, run by run."""
        return [
            self.cost(one) / self.cost(first)
            for one, first in zip(results, of_first[: len(results)], strict=True)
        ]

    def _currents(self, to_deg: float | None) -> dict[str, Any]:
        environment: dict[str, Any] = {"current_m_s": 0.0}
        if to_deg is not None:
            environment = {"current_m_s": self._current_m_s, "current_to_deg": to_deg}
        return {"boat": {"model": self._model}, "environment": environment}
