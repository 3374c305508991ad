"""The figures of a run that a campaign tabulates. Nothing here depends on the machine or its clock."""

import dataclasses

import numpy as np

from companion.core.modes import Mode
from companion.vehicle.mission.steps import Waypoint
from sitl.experiments.campaign.fault_figures import fault_figures
from sitl.experiments.campaign.inevitable import inevitable
from sitl.experiments.campaign.motor_figures import motor_figures
from sitl.experiments.trial import Figures
from sitl.reports.estimate_overlay import Estimate
from sitl.run.sail import Result, Sailing
from sitl.scenarios.courses import tracking
from sitl.scenarios.station_keeping import station_figures

_OF_THE_MACHINE = frozenset(("cpu_seconds", "real_time_factor"))
_OF_THE_RUN = frozenset(("scenario", "seed"))  # columns of the run already


def figures_of(sailing: Sailing, result: Result) -> Figures:
    """What `boat-sitl sail` measures, and besides: tracking, station keeping, conduct."""
    out: Figures = {
        name: value
        for name, value in dataclasses.asdict(result).items()
        if name not in _OF_THE_MACHINE | _OF_THE_RUN
    }
    kept = tracking(sailing.recorder, sailing.planned) if len(sailing.planned) > 1 else None
    if kept is not None:
        out["path_rms_m"], out["path_max_m"] = kept.path_rms_m, kept.path_max_m
        out["kept_rms_m"], out["kept_max_m"] = kept.rms_m, kept.max_m  # once under way
        out["start_max_m"], out["overshoot_m"] = kept.start_max_m, kept.overshoot_m
    out["command_travel_per_s"] = _command_travel_per_s(sailing)
    if _stays(sailing):
        out.update(station_figures(sailing.recorder, sailing.planned[-1]))
    out.update(fault_figures(sailing))
    out.update(motor_figures(sailing))
    out["fault"] = ", ".join(f"{fault.what} {fault.kind}" for fault in sailing.scenario.faults)
    out["touches"] = len(sailing.timeline.touched)
    why = inevitable(sailing) if sailing.timeline.touched else ""
    out["inevitable"] = why
    out["avoidable_touches"] = 0 if why else len(sailing.timeline.touched)
    out["late_commands"] = sailing.timeline.late_commands
    out["is_settled"] = result.completed or not _still_sails(sailing)
    environment = sailing.scenario.environment
    out["current_m_s"], out["gust_m_s"] = environment.current_m_s, environment.gust_m_s
    return out


def _still_sails(sailing: Sailing) -> bool:
    """Whether an armed boat was still at its mission when its time was over."""
    vehicle = sailing.lockstep.boat.vehicle
    return vehicle.armed and vehicle.mode is Mode.AUTO


def _command_travel_per_s(sailing: Sailing) -> float | None:
    """How much both commands together go up and down in a second: what steering costs motors and gears."""
    rows = sailing.beliefs.rows
    if len(rows) < 2:
        return None
    commands = rows[:, [Estimate._fields.index("left"), Estimate._fields.index("right")]]
    return float(np.abs(np.diff(commands, axis=0)).sum() / (rows[-1, 0] - rows[0, 0]))


def _stays(sailing: Sailing) -> bool:
    """Whether the mission ends with keeping station for a while."""
    last = sailing.lockstep.boat.vehicle.progress.mission[-1]
    return isinstance(last, Waypoint) and last.hold_s > 0.0
