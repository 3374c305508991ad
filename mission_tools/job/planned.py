"""What `mission-plan` and `mission-upload` are asked for and report; a planned mission in words and files."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.drawing.preview import save_preview
from mission_tools.errors import UsageError
from mission_tools.maps.chart import Chart
from mission_tools.mission.mission import Mission, MissionType
from mission_tools.overwrite_guard import PICTURE_SUFFIXES, check_picture_name, check_replaceable
from mission_tools.tasks.task_route import TaskRoute
from mission_tools.vehicle.link_url import DEFAULT_LINK, DEFAULT_SYSTEM_ID
from mission_tools.wording import Printer, counted, distance, duration

if TYPE_CHECKING:
    from mission_tools.contract.budget import Budget
    from mission_tools.contract.split import Split
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
    resume: str | None = None  # of a split mission: this part alone, N, or its rest, N@ITEM
    diff: bool = False  # say what an upload changes aboard
    if_changed: bool = False  # and send only the lists that it changes


@dataclass(slots=True)
class Report:
    """The results so far, also of a job that fails."""

    planned: PlannedMission | None = None
    area_notes: tuple[str, ...] = ()  # on the files of fence and rally points
    budget: "Budget | None" = None
    split: "Split | None" = None
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
    saved_parts: dict[int, Path] = field(default_factory=dict)
    preview: Path | None = None


def check_outputs(
    save: Path | None, preview: Path | None, inputs: Iterable[Path | str | None], *, force: bool = False
) -> None:
    """See whether what is asked for can be written: in a known format, over nothing that is read, and over no
    other program's file unless forced. Raises PlanFileError, UsageError: names the file.
    """
    if preview is not None:
        check_picture_name(preview)
    if save is not None:
        if save.suffix.lower() in PICTURE_SUFFIXES:
            check_picture_name(save, "--save")
        else:
            from mission_tools.files.written import check_route_name  # noqa: PLC0415 - for files alone

            check_route_name(save)
    read = [Path(name) for name in inputs if name is not None]
    for option, output in (("--save", save), ("--preview", preview)):
        for given in read:
            if output is not None and output.exists() and given.exists() and output.samefile(given):
                raise UsageError(
                    f"{option} {output}: would overwrite {given}, which is read; choose another name"
                )
        if output is not None:
            check_replaceable(option, output, force=force)


def save(mission: Mission, path: Path, planned: PlannedMission | None = None) -> None:
    """Write a mission in the format of the file's suffix: also a picture, where there is a chart to draw.
    Raises PlanFileError: the format cannot hold it, or the file cannot be written. UsageError: a picture
    without a chart.
    """
    if path.suffix.lower() not in PICTURE_SUFFIXES:
        from mission_tools.files.written import save_route  # noqa: PLC0415 - for files alone

        is_file = planned is None or (planned.plan is None and planned.task is None)
        save_route(mission, path, "" if is_file or planned is None else planned.name)
    elif planned is None:
        raise UsageError(f"{path}: a picture needs a map to draw: name a .plan file or another format")
    else:
        save_preview(path, planned)


def take_planned(planned: PlannedMission, request: Request, report: Report, say: Printer) -> PlannedMission:
    """Describe what was planned and what it costs the boat, and save it; with the fence that was asked for.
    Raises NoRoute: no fence holds the route. UsageError: more items than the boat holds. BeyondRange: the
    boat does not come home. PlanFileError: it cannot be written.
    """
    planned = with_areas(planned, request)
    if request.options.current is not None or request.options.depart is not None:
        from mission_tools.assembly.timed import timed  # noqa: PLC0415 - seldom needed

        planned = timed(planned, request.options)
    report.planned = planned
    for line in described(planned):
        say(line)
    if request.options.boat is not None:
        from mission_tools.contract.budget import planned_budget  # noqa: PLC0415 - seldom needed
        from mission_tools.costs.boat import load_boat  # noqa: PLC0415

        boat = load_boat(request.options.boat, request.options.wind)
        report.budget = planned_budget(planned, boat, request.options.current)
        for line in report.budget.lines():
            say(line)
        if planned.timetable is not None:
            planned = replace(planned, timetable=planned.timetable.sailed(report.budget.under_way_s))
            report.planned = planned
        if not request.beyond_range:
            report.budget.check(one_way=request.one_way)
    for line in planned.timetable.lines() if planned.timetable is not None else ():
        say(line)
    if request.save is not None:
        save(planned.mission, request.save, planned)
        report.saved = request.save
        say(f"saved {request.save}")
    return planned


def with_areas(planned: PlannedMission, request: Request) -> PlannedMission:
    """The mission with the fence and rally points that were asked for, no longer than the boat holds. Raises
    NoRoute, UsageError: as `take_planned`.
    """
    if request.fence_from_map or request.rally_from_map:
        from mission_tools.contract.water_contract import with_contract  # noqa: PLC0415 - seldom needed
        from mission_tools.costs.boat import load_boat  # noqa: PLC0415

        wanted = {"with_fence": request.fence_from_map, "with_rally": request.rally_from_map}
        planned = with_contract(planned, load_boat(request.options.boat), **wanted)
    return _within_capacity(planned, request.options.boat)


def _within_capacity(planned: PlannedMission, boat: str | None) -> PlannedMission:
    """The mission, with a note if it has more items than this project's boat holds by default. Raises
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
    """Draw plan and track, if a picture is asked for. Raises OutputError: it cannot be written."""
    if request.preview is not None:
        shown = planned if report.split is None else report.split.whole
        save_preview(request.preview, shown, report.monitor)
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
            line += f"; {plan.expanded} cells of {distance(plan.cell_m)} searched"
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
