"""What a set of gains is tried on, and what it costs.

The course has right angles, a sharp turn and a gentle one, on legs of ten waypoint radii, so that it suits
a boat of any size. It is sailed in still water and in currents of a quarter of the cruise speed. A run costs

    (RMS + ¼ largest + ½ overshoot) / waypoint radius + EFFORT × command travel a second

with errors to the line of the leg being sailed, from when the boat has way; one that is not completed costs
FAILED. What a corner or a current costs whatever the gains are would drown what they do. So a set of gains
is judged by the ratio of its costs to those of the gains to begin with, run by run, in the same water and
with the same seed: 1 is as good as those, 0.9 a tenth better.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from companion.config.boat_config import BoatConfig
from companion.core.geo import LocalFrame, Point
from mission_tools.mission.plan_file import save_mission
from mission_tools.mission.route import mission_along
from sitl.experiments.campaign.run import Outcome, Run
from sitl.experiments.tuning.gains import Gains, settings_of
from sitl.scenarios.layers import Layer, merge

FAILED = 10.0
EFFORT = 0.01
LEG_RADII = 10.0
_CORNERS = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 1.0), (1.3, 1.7), (2.3, 2.0))
_CURRENT_SHARE = 0.25
_CURRENTS_TO_DEG = (None, 90.0, 225.0)


class Trials:
    """The trials of one boat: numbered runs for sets of gains, and the costs of what came out."""

    waters = len(_CURRENTS_TO_DEG)  # in how many a set of gains is tried for each seed

    def __init__(self, model: str, config: BoatConfig, frame: LocalFrame, folder: Path) -> None:
        """Lay out the course in a file of the folder."""
        self._model = model
        self._radius_m = config.guidance.waypoint_radius_m
        self._current_m_s = _CURRENT_SHARE * config.speed.cruise_m_s
        leg_m = LEG_RADII * self._radius_m
        points = [frame.to_global(Point(leg_m * north, leg_m * east)) for north, east in _CORNERS]
        self._course = folder / "course.waypoints"
        save_mission(mission_along(points), self._course)

    def runs(self, gains: Gains, seeds: range, first_number: int) -> list[Run]:
        """Every water with every seed, seed by seed."""
        return [
            Run(
                number=first_number + number,
                scenario="open",
                seed=seed,
                mission=str(self._course),
                settings=merge([Layer("", tree) for tree in (self._water(to_deg), settings_of(gains))]),
                source="tune",
            )
            for number, (seed, to_deg) in enumerate(
                (seed, to_deg) for seed in seeds for to_deg in _CURRENTS_TO_DEG
            )
        ]

    def cost(self, outcome: Outcome) -> float:
        """Of one run."""
        names = ("kept_rms_m", "kept_max_m", "overshoot_m", "command_travel_per_s")
        values = [outcome.figures.get(name) for name in names]
        if outcome.ended != "completed" or not all(isinstance(value, float) for value in values):
            return FAILED
        rms_m, max_m, overshoot_m, travel = (float(value or 0.0) for value in values)
        return (rms_m + 0.25 * max_m + 0.5 * overshoot_m) / self._radius_m + EFFORT * travel

    def ratios(self, outcomes: Sequence[Outcome], of_first: Sequence[Outcome]) -> list[float]:
        """Costs over those of the gains to begin with, run by run."""
        return [
            self.cost(one) / self.cost(first)
            for one, first in zip(outcomes, of_first[: len(outcomes)], strict=True)
        ]

    def _water(self, to_deg: float | None) -> dict[str, Any]:
        environment: dict[str, Any] = {"current_m_s": 0.0}
        if to_deg is not None:
            environment = {"current_m_s": self._current_m_s, "current_to_deg": to_deg}
        return {"boat": {"model": self._model}, "environment": environment}
