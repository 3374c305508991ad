"""The job of `mission-plan` and `mission-upload`: plan, write files, hand over to the session."""

from mission_tools.assembly.areas import NO_AREAS, Areas, open_areas
from mission_tools.assembly.open_source import open_source
from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.errors import UsageError
from mission_tools.job.parts import check_part_names, take_mission
from mission_tools.job.planned import Report, Request, check_outputs, draw
from mission_tools.vehicle.link_url import parse_link
from mission_tools.wording import Printer


def run(request: Request, report: Report, say: Printer) -> None:
    """Do the job; `report` is filled in on the way and `say` gets a line for every step. Raises
    MissionToolsError: what went wrong, with the exit code it stands for.
    """
    link = parse_link(request.link)
    inputs = (request.source, request.fence, request.rally, request.sign_key)
    check_outputs(request.save, request.preview, inputs, force=request.force)
    if request.resume is not None and not request.options.split:
        raise UsageError("--resume: only with --split, the options of which it repeats")
    if request.options.split and request.save is not None:
        check_part_names(request.save, force=request.force)
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
        from mission_tools.job.session import run_session  # noqa: PLC0415 - MAVSDK takes half a second

        run_session(request, link, source, areas, report, say)
    elif source is None:
        for line in areas.lines():
            say(line)
    else:
        planned = source.prepare()
        planned = take_mission(planned, request, report, say)
        draw(planned, request, report, say)


_OF_SOURCES = ("start", "follow", "save", "preview", "fence_from_map", "rally_from_map")


def _check_areas_alone(request: Request, areas: Areas) -> None:
    """See that nothing is asked for that needs a route. Raises UsageError: names the options."""
    unfit = [name for name in _OF_SOURCES if getattr(request, name)]
    if unfit or request.options != PlanOptions():
        options = ", ".join("--" + name.replace("_", "-") for name in unfit) or "options about the route"
        raise UsageError(f"no SOURCE: {options} would need a scenario, a map or a mission file")
    if areas == NO_AREAS:
        raise UsageError("nothing to upload: expected a SOURCE, --fence FILE or --rally FILE")
