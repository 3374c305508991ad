"""One run of a campaign: what it is, and what came out of it. Both travel between processes."""

import time
import traceback
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from companion.core.errors import BoatError
from companion.core.geo import Point
from companion.mavlink.items import MissionItem
from mission_tools.errors import MissionToolsError
from sitl.experiments.campaign.figures import Figures, figures_of
from sitl.run.operator import SailError
from sitl.run.sail import Sailing
from sitl.scenarios.layers import Layer
from sitl.scenarios.missions import fence_along, lay_out, plan_mission, read_mission, wire_items
from sitl.scenarios.scenario import Scenario, load_scenario
from sitl.scenarios.station_keeping import STATION, STAY_S

MOST_TRACK_POINTS = 400
_SLACK_S = 120.0  # to get to a station
_MOST_TRACEBACK = 4000  # characters


class Run(Struct, frozen=True, kw_only=True):
    """What to sail: exactly one of mission (a file), course, or neither: planned on the scenario's map.

    settings lie over the scenario's as --set does; factors are those of them that vary in the campaign,
    by their dotted names. fence: the outline of the water is uploaded as one. source: the campaign's file,
    for messages.
    """

    number: int
    scenario: str
    seed: int
    case: str = ""
    course: str = ""
    mission: str = ""
    settings: dict[str, Any] = msgspec.field(default_factory=dict)
    factors: dict[str, Any] = msgspec.field(default_factory=dict)
    timeout_s: float | None = None
    linger_s: float = 0.0
    fence: bool = False
    source: str = ""


class Outcome(Struct, frozen=True, kw_only=True):
    """What came of a run. ended: completed, not completed, refused or error; why: the boat's last words.

    track: east and north in metres, a point about every second, for pictures. cpu_s differs from time to
    time; everything else is a function of the run.
    """

    number: int
    ended: str
    why: str = ""
    figures: Figures = msgspec.field(default_factory=dict)
    touched: tuple[str, ...] = ()
    traceback: str = ""
    track: tuple[tuple[float, float], ...] = ()
    cpu_s: float = 0.0


def sail_run(run: Run) -> Outcome:
    """Sail one run to its end. Never raises: what goes wrong is an outcome, too."""
    began_s = time.process_time()
    sailing = None
    try:
        scenario = scenario_of(run)
        sailing = Sailing(scenario, items_of(run, scenario), fence=fence_along(scenario) if run.fence else ())
        result = sailing.run(_timeout_s(run), linger_s=run.linger_s)
        ended = "completed" if result.completed else "not completed"
        why = "" if result.completed else sailing.ending()
        figures, touched, trace = figures_of(sailing, result), tuple(sailing.timeline.touched), ""
    except SailError as error:
        ended, why, figures, touched, trace = "refused", str(error), {}, (), ""
    except (BoatError, MissionToolsError) as error:
        ended, why, figures, touched, trace = "error", str(error), {}, (), ""
    except Exception as error:  # one run's defect must not cost the others
        ended, why, figures, touched = "error", repr(error), {}, ()
        trace = traceback.format_exc()[-_MOST_TRACEBACK:]
    return Outcome(
        number=run.number,
        ended=ended,
        why=why,
        figures=figures,
        touched=touched,
        traceback=trace,
        track=() if sailing is None else _thinned(sailing.recorder.track()),
        cpu_s=time.process_time() - began_s,
    )


def scenario_of(run: Run) -> Scenario:
    """The run's scenario.

    Raises:
        ConfigError, MissionToolsError: it cannot be used; names file and key.
    """
    over = Layer(run.source or "campaign", {**run.settings, "seed": run.seed})
    return load_scenario(run.scenario, case=run.case or None, over=(over,))


def items_of(run: Run, scenario: Scenario) -> list[MissionItem]:
    """The run's mission.

    Raises:
        MissionToolsError: the file cannot be used, or no route can be planned.
    """
    if run.mission:
        return wire_items(read_mission(Path(run.mission)))
    return wire_items(lay_out(run.course, scenario) if run.course else plan_mission(scenario)[0])


def _timeout_s(run: Run) -> float | None:
    return STAY_S + _SLACK_S if run.timeout_s is None and run.course == STATION else run.timeout_s


def _thinned(track: list[Point]) -> tuple[tuple[float, float], ...]:
    every = max(50, len(track) // MOST_TRACK_POINTS)
    return tuple((round(at.east_m, 2), round(at.north_m, 2)) for at in track[::every])
