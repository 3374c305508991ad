"""The figures of a run that a campaign tabulates. Nothing here depends on the machine or its clock."""

import dataclasses

import numpy as np

from companion.core.modes import Mode
from companion.vehicle.mission.steps import Waypoint
from sitl.courses.courses import station_figures, tracking
from sitl.experiments.campaign.calm_figures import calm_figures
from sitl.experiments.campaign.fault_figures import fault_figures
from sitl.experiments.campaign.motor_figures import motor_figures
from sitl.experiments.campaign.unavoidable import unavoidable_cause
from sitl.experiments.trial import Figures
from sitl.run.mission_run import MissionRun, Result
from sitl.run.recording.estimate_recorder import Estimate

_OF_THE_MACHINE = frozenset(("cpu_seconds", "real_time_factor"))
_OF_THE_RUN = frozenset(("scenario", "seed"))  # columns of the run already


def figures_of(mission_run: MissionRun, result: Result) -> Figures:
    """The figures of `boat-sitl sail`, and those of path following, station keeping and faults."""
    out: Figures = {
        name: value
        for name, value in dataclasses.asdict(result).items()
        if name not in _OF_THE_MACHINE | _OF_THE_RUN
    }
    out.update(tracking(mission_run.recorder, mission_run.planned))
    out["command_travel_per_s"] = _command_travel_per_s(mission_run)
    vehicle = mission_run.lockstep.boat.vehicle
    last = vehicle.progress.mission[-1]
    if isinstance(last, Waypoint) and last.hold_s > 0.0:  # it ends with keeping station
        out.update(station_figures(mission_run.recorder, mission_run.planned[-1]))
    out.update(fault_figures(mission_run))
    out.update(motor_figures(mission_run))
    out.update(calm_figures(mission_run))
    out["fault"] = ", ".join(f"{fault.what} {fault.kind}" for fault in mission_run.scenario.faults)
    out["touches"] = len(mission_run.timeline.touched)
    why = unavoidable_cause(mission_run) if mission_run.timeline.touched else ""
    out["inevitable"] = why
    out["avoidable_touches"] = 0 if why else len(mission_run.timeline.touched)
    out["late_commands"] = mission_run.timeline.late_commands
    out["is_settled"] = result.completed or not (vehicle.armed and vehicle.mode is Mode.AUTO)
    environment = mission_run.scenario.environment
    out["current_m_s"], out["gust_m_s"] = environment.current_m_s, environment.gust_m_s
    out["wave_height_m"], out["wave_period_s"] = environment.wave_height_m, environment.wave_period_s
    return out


def _command_travel_per_s(mission_run: MissionRun) -> float | None:
    """The sum of both commands' changes per second: the wear on motors and gears."""
    rows = mission_run.estimates.rows
    if len(rows) < 2:
        return None
    commands = rows[:, [Estimate._fields.index("left"), Estimate._fields.index("right")]]
    return float(np.abs(np.diff(commands, axis=0)).sum() / (rows[-1, 0] - rows[0, 0]))
