"""A mission that is cut into parts, one for each pack, in words and files; and which of them is uploaded."""

from glob import escape
from pathlib import Path
from typing import TYPE_CHECKING

from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.errors import UsageError
from mission_tools.job.planned import Report, Request, described, save, take_planned, with_areas
from mission_tools.overwrite_guard import PICTURE_SUFFIXES, check_replaceable
from mission_tools.wording import Printer

if TYPE_CHECKING:
    from mission_tools.contract.split import Part, Split
    from mission_tools.costs.boat import Boat


def take_mission(planned: PlannedMission, request: Request, report: Report, say: Printer) -> PlannedMission:
    """Describe and save what was planned, with --split in parts; the mission to upload. Raises: as
    `take_planned` and `split`; UsageError: no such part.
    """
    if not request.options.split or request.options.boat is None:
        return take_planned(planned, request, report, say)
    from mission_tools.contract.split import split  # noqa: PLC0415 - seldom needed
    from mission_tools.costs.boat import load_boat  # noqa: PLC0415

    boat = load_boat(request.options.boat, request.options.wind)
    report.split = found = split(planned, boat, request.options.current)
    report.planned = found.whole
    for line in (*described(found.whole), *found.lines()):
        say(line)
    wanted = dict(enumerate(found.parts, 1))
    if request.resume is not None:
        wanted = _resumed(found, request.resume, boat, request.options.current)
    parts = {n: with_areas(part.planned, request) for n, part in wanted.items()}
    number, (_, report.budget) = next(iter(wanted.items()))
    if request.save is not None and request.save.suffix.lower() in PICTURE_SUFFIXES:
        save(found.whole.mission, request.save, found.whole)
        report.saved = request.save
        say(f"saved {request.save}")
    elif request.save is not None:
        for n, part in parts.items():
            name = f"{request.save.stem}_{n}" if request.resume is None else request.save.stem
            path = request.save.with_stem(name)
            save(part.mission, path, part)
            report.saved_parts[n] = path
            say(f"saved {path}")
        for path in set(_parts_of(request.save)) - set(report.saved_parts.values()):
            if request.resume is None:
                say(f"note: {path} is of an earlier split")
    if not request.dry_run:
        say(f"to be uploaded: part {number} of {len(found.parts)}")
    return parts[number]


def _resumed(found: "Split", resume: str, boat: "Boat", current: str | None) -> dict[int, "Part"]:
    """The part that N names, or what N@ITEM leaves of it."""
    name, at, item = resume.partition("@")
    if not name.isdecimal() or (at and not item.isdecimal()) or not 1 <= int(name) <= len(found.parts):
        most = len(found.parts)
        raise UsageError(f"--resume {resume}: expected N or N@ITEM, and a part N from 1 to {most}")
    part = found.parts[int(name) - 1]
    if at:
        from mission_tools.contract.split import rest_of  # noqa: PLC0415 - seldom needed

        part = rest_of(part.planned, int(item), boat, current)
    return {int(name): part}


def check_part_names(path: Path, *, force: bool) -> None:
    """See whether the files of parts may be written. Raises UsageError: another program's file is there."""
    for part in _parts_of(path):
        check_replaceable("--save", part, force=force)


def _parts_of(path: Path) -> list[Path]:
    """The files that are there already."""
    return sorted(path.parent.glob(f"{escape(path.stem)}_[0-9]*{escape(path.suffix)}"))
