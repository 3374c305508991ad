"""What an experiment runs and what it gets back. Both travel between processes and to disk as JSON."""

import time
import traceback
from collections.abc import Callable
from typing import Any

import msgspec
from msgspec import Struct

from companion.core.errors import BoatError
from mission_tools.errors import MissionToolsError
from sitl.run.station_commands import RunError

Figure = float | int | str | bool | None
Figures = dict[str, Figure]

_MOST_TRACEBACK = 4000  # characters


class Trial(Struct, frozen=True, kw_only=True):
    """One simulation. The task decides what it does with a scenario.

    At most one of mission (a file) and course is given; with neither, the mission is planned on the
    scenario's map. settings override the scenario's, as --set does; below holds where the scenario has none;
    factors are what varies in the experiment, by name. fence: upload the outline of the water as a fence.
    source: where the settings come from, for messages.
    """

    number: int
    scenario: str
    seed: int
    case: str = ""
    course: str = ""
    mission: str = ""
    settings: dict[str, Any] = msgspec.field(default_factory=dict)
    factors: dict[str, Any] = msgspec.field(default_factory=dict)
    below: dict[str, Any] = msgspec.field(default_factory=dict)
    timeout_s: float | None = None
    linger_s: float = 0.0
    fence: bool = False
    source: str = ""


class TrialResult(Struct, frozen=True, kw_only=True):
    """The result of a trial. ended: completed, not completed, refused or error; why: the last messages.

    track: east and north in metres. Everything but cpu_s is a function of the trial.
    """

    number: int
    ended: str
    why: str = ""
    figures: Figures = msgspec.field(default_factory=dict)
    touched: tuple[str, ...] = ()
    traceback: str = ""
    track: tuple[tuple[float, float], ...] = ()
    cpu_s: float = 0.0

    def value(self, name: str) -> float:
        return float(self.figures[name] or 0.0)


Task = Callable[[Trial], TrialResult]


def attempt(task: Task, trial: Trial) -> TrialResult:
    """Run a trial. Never raises: a failure is a result, too."""
    began_s = time.process_time()
    try:
        result = task(trial)
    except RunError as error:
        result = TrialResult(number=trial.number, ended="refused", why=str(error))
    except (BoatError, MissionToolsError) as error:
        result = TrialResult(number=trial.number, ended="error", why=str(error))
    except Exception as error:  # a defect in one trial does not end the others
        trace = traceback.format_exc()[-_MOST_TRACEBACK:]
        result = TrialResult(number=trial.number, ended="error", why=repr(error), traceback=trace)
    return msgspec.structs.replace(result, cpu_s=time.process_time() - began_s)
