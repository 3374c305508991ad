"""The task of the avoidance experiment: the same leg without and with an obstacle."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cache
from itertools import product
from typing import Any, Literal

import msgspec

from companion.core.geo import Point, bearing_rad
from companion.obstacles.perception.looked_at import UNCHARTED
from companion.obstacles.planning.planner import GIVING_WAY, NO_WAY
from mission_tools.mission.route import mission_along
from sitl.courses.missions import wire_items
from sitl.experiments.encounters.avoiding import AvoidingRun, side_changes
from sitl.experiments.encounters.evasion import could_evade
from sitl.experiments.encounters.obstacles import (
    LEG_M,
    Kind,
    Meeting,
    Tree,
    meets_at_m,
    mover,
    still_obstacles,
)
from sitl.experiments.trial import Trial, TrialResult
from sitl.run.mission_run import MissionRun, Result
from sitl.scenarios.layers import COMMAND_LINE, Layer
from sitl.scenarios.scenario import load_scenario
from sitl.world.sampling import generator
from sitl.world.scenario import Scenario
from sitl.world.truth import Truth

MOST_S = 400.0
SONAR_M = 4.0  # sight without a second ranger
Ranger = Literal["scan", "forward"]
_COURSE_M = 2.0  # the boat's course at the meeting is measured over this distance


@dataclass(frozen=True, slots=True)
class Encounter:
    """A kind of obstacle, its speed, and the current."""

    kind: Kind
    speed_m_s: float = 0.0
    current_m_s: float = 0.0

    @property
    def name(self) -> str:
        moves = f" {self.speed_m_s:g} m/s" if self.speed_m_s else ""
        current = f", current {self.current_m_s:g} m/s" if self.current_m_s else ""
        return f"{self.kind.replace('_', ' ')}{moves}{current}"


def second_ranger(sight_m: float, ranger: Ranger) -> list[str]:
    """Settings for a second ranger: a 2-D scan as OBSTACLE_DISTANCE, or one beam ahead as DISTANCE_SENSOR."""
    return [
        "sensors.lidar.fitted=true",
        f"sensors.lidar.max_range_m={sight_m}",
        f"sensors.lidar.field_deg={0 if ranger == 'forward' else 180}",
        "vehicle.external.obstacles=true",
        f"vehicle.avoidance.lookahead_m={sight_m}",
    ]


def encounter_trials(
    encounters: Sequence[Encounter], seeds: Sequence[int], settings: dict[str, Any]
) -> list[Trial]:
    """Every encounter with every seed. settings: override the scenario's."""
    return [
        Trial(
            number=number,
            scenario="open",
            seed=seed,
            settings=settings,
            factors=asdict(one),
            source=COMMAND_LINE,
        )
        for number, (one, seed) in enumerate(product(encounters, seeds), 1)
    ]


def run_encounter(trial: Trial) -> TrialResult:
    """Simulate one encounter. The figures, from ground truth:

    touches: contacts of the hull; inevitable: whether no manoeuvre after the mover's first possible echo
    would have kept clear; unheard: the same after the first echo that was heard; moves_told and no_way_told:
    messages to the operator; alone_s: the duration without an obstacle; avoiding_s: while the local planner
    steers; avoiding_travel: full scales of the busier motor in that time; side_changes: of the reported side.

    Raises:
        RunError: the boat did not arm or start.
    """
    alone_s, scenario = encounter_scenario(trial)
    mission_run, result = _sail(scenario)
    touches = mission_run.lockstep.world.groundings
    texts = [event.text for event in mission_run.timeline.events if event.kind == "text"]
    is_inevitable = is_unheard = False
    if touches and scenario.movers:
        rows, heard_s = mission_run.recorder.rows, mission_run.lockstep.mover_heard_s
        is_inevitable = not could_evade(scenario, rows)
        is_unheard = is_inevitable or not could_evade(scenario, rows, heard_s)
    return TrialResult(
        number=trial.number,
        ended="completed" if result.completed else "not completed",
        figures={
            "touches": touches,
            "inevitable": is_inevitable,
            "unheard": is_unheard,
            "time_s": result.time_s,
            "alone_s": alone_s,
            "moves_told": texts.count(GIVING_WAY),
            "no_way_told": texts.count(NO_WAY),
            "avoiding_s": mission_run.avoiding_s,
            "avoiding_travel": max(mission_run.travels),
            "side_changes": side_changes(texts),
        },
    )


def sail_encounter(trial: Trial) -> MissionRun:
    """One encounter, sailed.

    Raises:
        RunError: the boat did not arm or start.
    """
    return _sail(encounter_scenario(trial)[1])[0]


def encounter_scenario(trial: Trial) -> tuple[float, Scenario]:
    """The duration without an obstacle, and the scenario with it."""
    encounter = Encounter(**trial.factors)
    alone_s, track = _alone(encounter.current_m_s, trial.seed, msgspec.json.encode(trial.settings))
    if encounter.speed_m_s:
        meeting = _meeting(track, meets_at_m(encounter.kind, trial.seed))
        tree: Tree = {"movers": [mover(encounter.kind, trial.seed, encounter.speed_m_s, meeting)]}
    else:
        tree = still_obstacles(encounter.kind, trial.seed)
    return alone_s, _scenario(encounter.current_m_s, trial.seed, trial.settings, tree)


def _scenario(current_m_s: float, seed: int, settings: dict[str, Any], tree: Tree) -> Scenario:
    towards_deg = generator(seed, "encounter/current").uniform(0.0, 360.0)
    environment = {"current_m_s": current_m_s, "current_to_deg": towards_deg}
    vehicle = {"avoidance": {"by_sight": UNCHARTED}}  # no map has this water
    layer = Layer("encounter", {"seed": seed, "environment": environment, "vehicle": vehicle, **tree})
    return load_scenario("open", over=[layer, Layer(COMMAND_LINE, settings)])


def _sail(scenario: Scenario) -> tuple[AvoidingRun, Result]:
    leg = [scenario.frame.to_global(Point(north_m, 0.0)) for north_m in (0.0, LEG_M)]
    mission_run = AvoidingRun(scenario, wire_items(mission_along(leg)))
    return mission_run, mission_run.run(timeout_s=MOST_S)


@cache
def _alone(current_m_s: float, seed: int, settings: bytes) -> tuple[float, tuple[tuple[float, Point], ...]]:
    """The run without an obstacle: its duration, and the boat's position by time. settings: JSON."""
    mission_run, result = _sail(_scenario(current_m_s, seed, msgspec.json.decode(settings), {}))
    fields = [Truth._fields.index(name) for name in ("time_s", "north_m", "east_m")]
    rows = mission_run.recorder.rows[:, fields].tolist()
    return result.time_s, tuple((time_s, Point(north_m, east_m)) for time_s, north_m, east_m in rows)


def _meeting(track: Sequence[tuple[float, Point]], along_m: float) -> Meeting:
    """Where the boat was when it had travelled along_m on the leg."""
    time_s, at = next(one for one in track if one[1].north_m >= along_m)
    _, before = next(one for one in track if one[1].north_m >= along_m - _COURSE_M)
    return Meeting(time_s, at, bearing_rad(before, at))
