"""One encounter: the same run without and with what is in the way."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from companion.core.geo import Point, bearing_rad
from mission_tools.mission.route import mission_along
from sitl.experiments.encounters.dodge import could_dodge
from sitl.experiments.encounters.waters import LEG_M, Kind, Meeting, Tree, meets_at_m, mover, still_water
from sitl.run.sail import Result, Sailing
from sitl.scenarios.layers import Layer
from sitl.scenarios.missions import wire_items
from sitl.scenarios.scenario import Scenario, load_scenario
from sitl.world.sensors import generator
from sitl.world.world import Truth

MOST_S = 400.0
_COURSE_M = 2.0  # over which the boat's course at the meeting is told


@dataclass(frozen=True, slots=True)
class Water:
    """What is sailed through: a kind of encounter, how fast it moves, and the current."""

    kind: Kind
    speed_m_s: float = 0.0
    current_m_s: float = 0.0

    @property
    def name(self) -> str:
        """For tables."""
        moves = f" {self.speed_m_s:g} m/s" if self.speed_m_s else ""
        sets = f", current {self.current_m_s:g} m/s" if self.current_m_s else ""
        return f"{self.kind.replace('_', ' ')}{moves}{sets}"


@dataclass(frozen=True, slots=True)
class Trial:
    """Figures of one encounter, from the truth.

    touches: how often the hull met something, each one apart; could_help: whether some simple manoeuvre from
    the moment at which the ranger could first have heard the mover would have kept clear. moves_told and
    no_way_told count the boat's words. alone_s: the time without anything in the way.
    """

    water: Water
    seed: int
    completed: bool
    touches: int
    could_help: bool
    time_s: float
    alone_s: float
    moves_told: int
    no_way_told: int


def sail_encounter(water: Water, seed: int, settings: tuple[str, ...] = ()) -> Trial:
    """Sail one.

    settings: over the scenario's, as --set has them.

    Raises:
        SailError: the boat would not arm or start.
    """
    alone = _alone(water.current_m_s, seed, settings)
    if water.speed_m_s:
        meeting = _meeting(alone.track, meets_at_m(water.kind, seed))
        tree: Tree = {"movers": [mover(water.kind, seed, water.speed_m_s, meeting)]}
    else:
        tree = still_water(water.kind, seed)
    scenario = _scenario(water.current_m_s, seed, settings, tree)
    sailing, result = _sail(scenario)
    touches = sailing.lockstep.world.groundings
    words = [event.text for event in sailing.timeline.events if event.kind == "text"]
    return Trial(
        water=water,
        seed=seed,
        completed=result.completed,
        touches=touches,
        could_help=not touches or not water.speed_m_s or could_dodge(scenario, sailing.recorder.rows),
        time_s=result.time_s,
        alone_s=alone.time_s,
        moves_told=sum("moves" in text for text in words),
        no_way_told=sum("no way round" in text for text in words),
    )


def _scenario(current_m_s: float, seed: int, settings: tuple[str, ...], tree: Tree) -> Scenario:
    towards_deg = generator(seed, "encounter/current").uniform(0.0, 360.0)
    environment = {"current_m_s": current_m_s, "current_to_deg": towards_deg}
    layer = Layer("encounter", {"seed": seed, "environment": environment, **tree})
    return load_scenario("open", settings, over=[layer])


def _sail(scenario: Scenario) -> tuple[Sailing, Result]:
    leg = [scenario.frame.to_global(Point(north_m, 0.0)) for north_m in (0.0, LEG_M)]
    sailing = Sailing(scenario, wire_items(mission_along(leg)))
    return sailing, sailing.run(timeout_s=MOST_S)


@dataclass(frozen=True, slots=True)
class _Alone:
    """A run with nothing in the way: how long it took, and when the boat was where."""

    time_s: float
    track: tuple[tuple[float, Point], ...]


@cache
def _alone(current_m_s: float, seed: int, settings: tuple[str, ...]) -> _Alone:
    sailing, result = _sail(_scenario(current_m_s, seed, settings, {}))
    fields = [Truth._fields.index(name) for name in ("time_s", "north_m", "east_m")]
    rows = sailing.recorder.rows[:, fields].tolist()
    return _Alone(result.time_s, tuple((time_s, Point(north_m, east_m)) for time_s, north_m, east_m in rows))


def _meeting(track: Sequence[tuple[float, Point]], along_m: float) -> Meeting:
    """Where the boat was when it had come so far along the leg."""
    time_s, at = next(one for one in track if one[1].north_m >= along_m)
    _, before = next(one for one in track if one[1].north_m >= along_m - _COURSE_M)
    return Meeting(time_s, at, bearing_rad(before, at))
