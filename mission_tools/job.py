"""The job of `mission-plan` and `mission-upload`: plan, write files, hand over to the session."""

import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from mission_tools.errors import UsageError
from mission_tools.maps.chart import Chart
from mission_tools.mission.areas import NO_AREAS, Areas, open_areas
from mission_tools.mission.mission import MissionType
from mission_tools.mission.plan_options import PlanOptions
from mission_tools.mission.planned_mission import PlannedMission, open_source
from mission_tools.outputs import check_outputs, draw_planned, save
from mission_tools.tasks.task_route import TaskRoute
from mission_tools.vehicle.link_url import DEFAULT_LINK, DEFAULT_SYSTEM_ID, parse_link
from mission_tools.wording import Printer, counted, distance, duration

if TYPE_CHECKING:
    from mission_tools.contract.budget import Budget
    from mission_tools.vehicle.mission_monitor import MissionMonitor

MOST_ITEMS = 5000  # of a mission on this project's boat: mission.max_items, unless its file says otherwise


@dataclass(frozen=True, slots=True)
class Request:
    """What was asked for. source: None for fence and rally points alone, and the boat's mission stays."""

    source: str | None
    options: PlanOptions = field(default_factory=PlanOptions)
    link: str = DEFAULT_LINK
    system_id: int = DEFAULT_SYSTEM_ID
    patience_s: float = 10.0  # for the first heartbeat, the first position, and for arming
    start: bool = False
    follow: bool = False
    watch: bool = False  # and lead the mission round what the vehicle's rangers see
    timeout_s: float = math.inf
    dry_run: bool = False
    save: Path | None = None
    preview: Path | None = None
    force: bool = False  # replace files that other programs wrote
    sign_key: Path | None = None
    fence: str | None = None  # a file, or "none" to clear
    rally: str | None = None
    one_way: bool = False  # it need not come home
    beyond_range: bool = False  # plan it even if the charge does not suffice
    fence_from_map: bool = False
    rally_from_map: bool = False
    diff: bool = False  # say what an upload changes aboard
    if_changed: bool = False  # and send only the lists that it changes


@dataclass(slots=True)
class Report:
    """The results so far, also of a job that fails."""

    planned: PlannedMission | None = None
    area_notes: tuple[str, ...] = ()  # on the files of fence and rally points
    budget: "Budget | None" = None
    link: str = ""
    vehicle_id: int | None = None
    mode: str = ""
    items: int = 0
    lists: dict[str, int] = field(default_factory=dict)  # items of each list, cleared ones too
    changed: list[str] | None = None  # lists that differ from those on board; None: not compared
    upload_s: float = math.nan
    read_back_s: float = math.nan
    read_back_equal: bool = False
    started: bool = False
    monitor: "MissionMonitor | None" = None
    saved: Path | None = None
    preview: Path | None = None


def run(request: Request, report: Report, say: Printer) -> None:
    """Do the job; `report` is filled in on the way and `say` gets a line for every step.

    Raises:
        MissionToolsError: what went wrong, with the exit code it stands for.
    """
    link = parse_link(request.link)
    inputs = (request.source, request.fence, request.rally, request.sign_key)
    check_outputs(request.save, request.preview, inputs, force=request.force)
    for option in ("fence", "rally"):
        if getattr(request, option) is not None and getattr(request, f"{option}_from_map"):
            raise UsageError(f"--{option} and --{option}-from-map exclude each other")
    areas = open_areas(request.fence, request.rally)
    report.area_notes = areas.notes
    source = None
    if request.source is None:
        _check_areas_alone(request, areas)
    else:
        source = open_source(request.source, request.options, areas)
    if request.dry_run and (request.diff or request.if_changed):
        option = "--if-changed" if request.if_changed else "--diff"
        say(f"note: {option} compares with what is on board, and --dry-run asks no vehicle: nothing compared")
    if not request.dry_run:
        from mission_tools.vehicle.session import run_session  # noqa: PLC0415 - MAVSDK takes half a second

        run_session(request, link, source, areas, report, say)
    elif source is None:
        for line in areas.lines():
            say(line)
    else:
        planned = source.prepare()
        planned = take_planned(planned, request, report, say)
        draw(planned, request, report, say)


_OF_SOURCES = ("start", "follow", "save", "preview", "fence_from_map", "rally_from_map")


def _check_areas_alone(request: Request, areas: Areas) -> None:
    """See that nothing is asked for that needs a route.

    Raises:
        UsageError: names the options.
    """
    unfit = [name for name in _OF_SOURCES if getattr(request, name)]
    if unfit or request.options != PlanOptions():
        options = ", ".join("--" + name.replace("_", "-") for name in unfit) or "options about the route"
        raise UsageError(f"no SOURCE: {options} would need a scenario, a map or a mission file")
    if areas == NO_AREAS:
        raise UsageError("nothing to upload: expected a SOURCE, --fence FILE or --rally FILE")


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
        from mission_tools.contract.boat import load_boat  # noqa: PLC0415 - seldom needed

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
