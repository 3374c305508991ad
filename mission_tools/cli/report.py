"""A finished upload as plain values for JSON. Lengths in metres, times in seconds, null where not known."""

import math
from typing import TYPE_CHECKING, Any

from mission_tools.job import Report
from mission_tools.mission.planned_mission import PlannedMission
from mission_tools.planning.planner import Plan

if TYPE_CHECKING:
    from mission_tools.contract.budget import Budget
    from mission_tools.vehicle.mission_monitor import MissionMonitor


def as_json(report: Report) -> dict[str, Any]:
    """The report as a tree of plain values."""
    planned = report.planned
    mission = planned.mission if planned else None
    return {
        "ok": True,
        "exit_code": 0,
        "source": planned.name if planned else None,
        "waypoints": [[place.lat_deg, place.lon_deg] for place in mission.places] if mission else [],
        "home": [mission.home.lat_deg, mission.home.lon_deg] if mission and mission.home else None,
        "plan": _plan(planned.plan) if planned and planned.plan else None,
        "task": _task(planned) if planned and planned.task else None,
        "budget": _budget(report.budget) if report.budget else None,
        "upload": None if report.vehicle_id is None else _upload(report),
        "notes": list(planned.notes if planned else report.area_notes),
        "started": report.started,
        "voyage": _voyage(report.monitor) if report.monitor else None,
        "saved": str(report.saved) if report.saved else None,
        "preview": str(report.preview) if report.preview else None,
    }


def _plan(plan: Plan) -> dict[str, Any]:
    return {
        "length_m": plan.length_m,
        "straight_m": plan.straight_m,
        "min_clearance_m": _finite(plan.min_clearance_m),
        "clearance_m": plan.settings.clearance_m,
        "method": "exact" if plan.cell_m is None else "grid",
        "cell_m": plan.cell_m,
        "heuristic": plan.settings.heuristic,
        "smooth": plan.settings.smooth,
        "expanded": plan.search.expanded,
        "notes": list(plan.notes),
    }


def _task(planned: PlannedMission) -> dict[str, Any]:
    task = planned.task
    assert task is not None  # noqa: S101  the caller's question
    return {
        "length_m": task.length_m,
        "hold_s": task.hold_s,
        "min_clearance_m": _finite(task.min_clearance_m(planned.chart)),
        "clearance_m": planned.clearance_m,
        "legs": [{"kind": leg.kind, "length_m": leg.length_m, "hold_s": leg.hold_s} for leg in task.legs],
        "notes": list(task.notes),
    }


def _budget(budget: "Budget") -> dict[str, Any]:
    tree = {name: getattr(budget, name) for name in budget.__slots__}
    return {name: _finite(value) if isinstance(value, float) else value for name, value in tree.items()}


def _upload(report: Report) -> dict[str, Any]:
    return {
        "link": report.link,
        "system_id": report.vehicle_id,
        "mode": report.mode,
        "items": report.items,
        "lists": report.lists,
        "changed": report.changed,
        "upload_s": _finite(report.upload_s),
        "read_back_s": _finite(report.read_back_s),
        "read_back_equal": report.read_back_equal,
    }


def _voyage(monitor: "MissionMonitor") -> dict[str, Any]:
    return {
        "time_s": monitor.duration_s,
        "track_length_m": monitor.track_length_m,
        "track": [
            [point.time_s - monitor.track[0].time_s, point.place.lat_deg, point.place.lon_deg]
            for point in monitor.track
        ],
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
