"""A planned mission in words, with its budget, fence and files."""

import math
from dataclasses import replace

from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.errors import UsageError
from mission_tools.job.outputs import draw_planned, save
from mission_tools.job.request import Report, Request
from mission_tools.maps.chart import Chart
from mission_tools.mission.mission import MissionType
from mission_tools.tasks.task_route import TaskRoute
from mission_tools.wording import Printer, counted, distance, duration

MOST_ITEMS = 5000  # of a mission on this project's boat: mission.max_items, unless its file says otherwise


def take_planned(planned: PlannedMission, request: Request, report: Report, say: Printer) -> PlannedMission:
    """Describe what was planned and what it costs the boat, and save it; with the fence that was asked for.

    Raises:
        NoRoute: no fence holds the route.
        UsageError: more items than the boat holds.
        BeyondRange: the boat does not come home.
        PlanFileError: it cannot be written.
    """
    if request.fence_from_map or request.rally_from_map:
        planned = _with_contract(planned, request)
    planned = _within_capacity(planned, request.options.boat)
    report.planned = planned
    for line in described(planned):
        say(line)
    if request.options.boat is not None:
        from mission_tools.contract.planned_budget import planned_budget  # noqa: PLC0415 - seldom needed

        report.budget = planned_budget(planned, request.options.boat, request.options.current)
        for line in report.budget.lines():
            say(line)
        if not request.beyond_range:
            report.budget.check(one_way=request.one_way)
    if request.save is not None:
        save(planned.mission, request.save, planned)
        report.saved = request.save
        say(f"saved {request.save}")
    return planned


def _with_contract(planned: PlannedMission, request: Request) -> PlannedMission:
    from mission_tools.contract.water_contract import capacity_of, with_contract  # noqa: PLC0415 - seldom needed

    capacity = capacity_of(request.options.boat)
    return with_contract(
        planned, capacity, with_fence=request.fence_from_map, with_rally=request.rally_from_map
    )


def _within_capacity(planned: PlannedMission, boat: str | None) -> PlannedMission:
    """The mission, with a note if it has more items than this project's boat holds by default.

    Raises:
        UsageError: more than the named boat holds.
    """
    items = len(planned.mission.wire_lists(home_first=True)[MissionType.MISSION])
    most = MOST_ITEMS
    if boat is not None:
        from mission_tools.costs.boat import load_boat  # noqa: PLC0415 - seldom needed

        most = load_boat(boat).most_items
    if items <= most:
        return planned
    said = f"{items} mission items, home included, are more than the {most} that the boat holds"
    if boat is not None:
        raise UsageError(f"{planned.name}: {said} (mission.max_items of {boat}): plan it in parts")
    return replace(planned, notes=(*planned.notes, f"{said}, unless it is set up for more: plan it in parts"))


def draw(planned: PlannedMission, request: Request, report: Report, say: Printer) -> None:
    """Draw plan and track, if a picture is asked for.

    Raises:
        OutputError: it cannot be written.
    """
    if request.preview is not None:
        draw_planned(planned, request.preview, report.monitor)
        report.preview = request.preview
        say(f"drew {request.preview}")


def described(planned: PlannedMission) -> list[str]:
    """The plan in a line, and its notes."""
    mission, plan = planned.mission, planned.plan
    line = f"{planned.name}: {counted(len(mission.places), 'waypoint')}"
    if plan is not None:
        line += f", {distance(plan.length_m)} (straight {distance(plan.straight_m)})"
        if math.isfinite(plan.min_clearance_m):
            line += f", never nearer than {distance(plan.min_clearance_m)} to anything"
        if plan.cell_m is not None:
            line += f"; {plan.search.expanded} cells of {distance(plan.cell_m)} searched"
    elif planned.task is not None:
        line += _legs(planned.task, planned.chart)
    return [line, *(f"note: {note}" for note in planned.notes)]


def _legs(task: TaskRoute, chart: Chart) -> str:
    """The length of a task by kinds of legs, its clearance and its holds."""
    kinds = {leg.kind: task.length_of_m(leg.kind) for leg in task.legs}
    said = f", {distance(task.length_m)}"
    if len(kinds) > 1:
        said += f" ({', '.join(f'{kind} {distance(length_m)}' for kind, length_m in kinds.items())})"
    nearest_m = task.min_clearance_m(chart)
    if math.isfinite(nearest_m):
        said += f", never nearer than {distance(nearest_m)} to anything"
    return said + (f"; holds for {duration(task.hold_s)}" if task.hold_s > 0.0 else "")
