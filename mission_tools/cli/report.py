"""A finished upload as plain values for JSON. Lengths in metres, times in seconds, null where not known."""

import math
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from companion.core.geo import distance_m
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.job.planned import Report
from mission_tools.mission.mission import MissionItem
from mission_tools.planning.planner import Plan

if TYPE_CHECKING:
    from mission_tools.contract.budget import Budget
    from mission_tools.contract.split import Split
    from mission_tools.vehicle.mission_monitor import MissionMonitor


def as_json(report: Report, *, with_items: bool = False) -> dict[str, Any]:
    """The report as a tree of plain values. with_items: also each item as MISSION_ITEM_INT has it."""
    planned = report.planned
    mission = planned.mission if planned else None
    tree = {
        "ok": True,
        "exit_code": 0,
        "source": planned.name if planned else None,
        "waypoints": [[place.lat_deg, place.lon_deg] for place in mission.places] if mission else [],
        "home": [mission.home.lat_deg, mission.home.lon_deg] if mission and mission.home else None,
        "plan": _plan(planned.plan) if planned and planned.plan else None,
        "task": _task(planned) if planned and planned.task else None,
        "file": _file(planned) if planned and not planned.plan and not planned.task else None,
        "timetable": planned.timetable.as_json() if planned and planned.timetable else None,
        "budget": _budget(report.budget) if report.budget else None,
        "split": _split(report.split, report.saved_parts) if report.split else None,
        "upload": None if report.vehicle_id is None else _upload(report),
        "notes": list(planned.notes if planned else report.area_notes),
        "started": report.started,
        "voyage": _voyage(report.monitor) if report.monitor else None,
        "saved": str(report.saved) if report.saved else None,
        "preview": str(report.preview) if report.preview else None,
    }
    if with_items and mission is not None:
        lists = mission.wire_lists(home_first=True)
        tree["items"] = {kind.name.lower(): [*map(_item, items)] for kind, items in lists.items()}
    return tree


def _item(item: MissionItem) -> list[Any]:
    """Frame, command, autocontinue, four parameters, x, y, z; null stands for NaN."""
    numbers = [*map(_finite, item.params), item.x, item.y, _finite(item.z)]
    return [int(item.frame), int(item.command), int(item.autocontinue), *numbers]


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
        "expanded": plan.expanded,
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


def _file(planned: PlannedMission) -> dict[str, Any]:
    legs = [*pairwise(planned.points)]
    nearest_m = min((planned.chart.leg_clearance_m(*leg) for leg in legs), default=math.inf)
    return {
        "length_m": sum(distance_m(*leg) for leg in legs),
        "hold_s": sum(item.hold_s for item in planned.mission.items),
        "min_clearance_m": _finite(nearest_m),
    }


def _budget(budget: "Budget") -> dict[str, Any]:
    tree = {name: getattr(budget, name) for name in budget.__slots__}
    plain = {name: _finite(value) if isinstance(value, float) else value for name, value in tree.items()}
    return plain | {"suffices": budget.suffices}


def _split(found: "Split", saved: Mapping[int, Path]) -> dict[str, Any]:
    rows = [
        {"saved": str(saved[n]) if n in saved else None, **_budget(part.budget)}
        for n, part in enumerate(found.parts, 1)
    ]
    return {"least": found.least, "work_mah": found.work_mah, "parts": rows}


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
