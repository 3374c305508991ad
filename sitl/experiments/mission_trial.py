"""The task of campaigns and tuning: one mission, simulated from boot to its end."""

from pathlib import Path

from mission_tools.mission.mission import Mission
from mission_tools.mission.plan_file import load_mission
from sitl.courses.courses import STATION, STAY_S
from sitl.courses.missions import lay_out, plan_mission, wire_fence, wire_items
from sitl.experiments.campaign.figures import figures_of
from sitl.experiments.trial import Trial, TrialResult
from sitl.run.mission_run import MissionRun
from sitl.scenarios.layers import Layer
from sitl.scenarios.scenario import load_scenario
from sitl.world.scenario import Scenario

MOST_TRACK_POINTS = 400
_MARGIN_S = 120.0  # to reach a station


def run_mission(trial: Trial) -> TrialResult:
    """The figures of the mission, and its track with a point about every second.

    Raises RunError: the boat refused the mission or did not start; ConfigError, MissionToolsError: a setting
    or file cannot be used, or no route can be planned.
    """
    scenario = scenario_of(trial)
    mission = _mission_of(trial, scenario)
    fence = wire_fence(mission, scenario, has_outline=trial.fence)
    mission_run = MissionRun(scenario, wire_items(mission), fence=fence)
    timeout_s = trial.timeout_s
    if timeout_s is None and trial.course == STATION:
        timeout_s = STAY_S + _MARGIN_S
    result = mission_run.run(timeout_s, linger_s=trial.linger_s)
    track = mission_run.recorder.track()
    every = max(50, len(track) // MOST_TRACK_POINTS)
    return TrialResult(
        number=trial.number,
        ended="completed" if result.completed else "not completed",
        why="" if result.completed else mission_run.ending(),
        figures=figures_of(mission_run, result),
        touched=tuple(mission_run.timeline.touched),
        track=tuple((round(at.east_m, 2), round(at.north_m, 2)) for at in track[::every]),
    )


def scenario_of(trial: Trial) -> Scenario:
    """The trial's scenario. Raises ConfigError, MissionToolsError: it cannot be used; names file and key."""
    over = Layer(trial.source or "campaign", {**trial.settings, "seed": trial.seed})
    below = (Layer("below", trial.below),) if trial.below else ()
    return load_scenario(trial.scenario, case=trial.case or None, over=(over,), below=below)


def _mission_of(trial: Trial, scenario: Scenario) -> Mission:
    if trial.mission:
        return load_mission(Path(trial.mission))
    return lay_out(trial.course, scenario) if trial.course else plan_mission(scenario)[0]
