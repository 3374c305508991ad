"""A mission that is cut into parts, one for each pack, in words and files; and which of them is uploaded."""

import re
from pathlib import Path

from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.errors import UsageError
from mission_tools.job.planned import Report, Request, described, save, take_planned, with_areas
from mission_tools.overwrite_guard import PICTURE_SUFFIXES, check_replaceable
from mission_tools.wording import Printer, counted


def take_mission(planned: PlannedMission, request: Request, report: Report, say: Printer) -> PlannedMission:
    """Describe and save what was planned, with --split in parts; the mission to upload. Raises: as
    `take_planned` and `split`; UsageError: no such part.
    """
    if not request.options.split or request.options.boat is None:
        return take_planned(planned, request, report, say)
    from mission_tools.contract.split import split  # noqa: PLC0415 - seldom needed

    report.split = found = split(planned, request.options.boat, request.options.current)
    report.planned = found.whole
    for line in (*described(found.whole), *found.lines()):
        say(line)
    count, number = len(found.parts), request.resume or 1
    if number > count:
        raise UsageError(f"--resume {number}: there is no such part, but {counted(count, 'part')}")
    wanted = range(1, count + 1) if request.resume is None else [number]
    parts = {n: with_areas(found.parts[n - 1].planned, request) for n in wanted}
    report.budget = found.parts[number - 1].budget
    if request.save is not None and request.save.suffix.lower() in PICTURE_SUFFIXES:
        save(found.whole.mission, request.save, found.whole, found.labelled)
        report.saved = request.save
        say(f"saved {request.save}")
    elif request.save is not None:
        for n, part in parts.items():
            path = request.save if request.resume is not None else part_path(request.save, n)
            save(part.mission, path, part)
            report.saved_parts[n] = path
            say(f"saved {path}")
        for path in set(_parts_of(request.save)) - set(report.saved_parts.values()):
            if request.resume is None:
                say(f"note: {path} is of an earlier split")
    return parts[number]


def part_path(path: Path, number: int) -> Path:
    """The file of a part: survey_2.plan of survey.plan."""
    return path.with_stem(f"{path.stem}_{number}")


def check_part_names(path: Path, *, force: bool) -> None:
    """See whether the files of parts may be written. Raises UsageError: another program's file is there."""
    for part in _parts_of(path):
        check_replaceable("--save", part, force=force)


def _parts_of(path: Path) -> list[Path]:
    """The files that are there already."""
    name = re.compile(rf"{re.escape(path.stem)}_[0-9]+{re.escape(path.suffix)}")
    return sorted(file for file in path.parent.glob(f"*{path.suffix}") if name.fullmatch(file.name))
