"""The files that a job writes: checked before the work, written after it."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from mission_tools.drawing.names import PICTURE_SUFFIXES, check_picture_name
from mission_tools.errors import UsageError
from mission_tools.mission.mission import Mission
from mission_tools.overwrite_guard import check_replaceable

if TYPE_CHECKING:
    from mission_tools.assembly.planned_mission import PlannedMission
    from mission_tools.vehicle.mission_monitor import MissionMonitor


def check_outputs(
    save: Path | None, preview: Path | None, inputs: Iterable[Path | str | None], *, force: bool = False
) -> None:
    """See whether what is asked for can be written: in a known format, over nothing that is read, and over no
    other program's file unless forced.

    Raises:
        PlanFileError, UsageError: names the file.
    """
    if preview is not None:
        check_picture_name(preview)
    if save is not None:
        if save.suffix.lower() in PICTURE_SUFFIXES:
            check_picture_name(save, "--save")
        else:
            from mission_tools.files.formats import check_route_name  # noqa: PLC0415 - for files alone

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


def save(mission: Mission, path: Path, planned: "PlannedMission | None" = None) -> None:
    """Write a mission in the format of the file's suffix: also a picture, where there is a chart to draw.

    Raises:
        PlanFileError: the format cannot hold it, or the file cannot be written.
        UsageError: a picture without a chart.
    """
    if path.suffix.lower() not in PICTURE_SUFFIXES:
        from mission_tools.files.formats import save_route  # noqa: PLC0415 - for files alone

        is_file = planned is None or (planned.plan is None and planned.task is None)
        save_route(mission, path, "" if is_file or planned is None else planned.name)
    elif planned is None:
        raise UsageError(f"{path}: a picture needs a map to draw: name a .plan file or another format")
    else:
        draw_planned(planned, path)


def draw_planned(planned: "PlannedMission", path: Path, monitor: "MissionMonitor | None" = None) -> None:
    """Draw the mission, and the track that the monitor has kept.

    Raises:
        OutputError: the file cannot be written.
    """
    from mission_tools.drawing.preview import save_preview  # noqa: PLC0415 - seldom needed

    save_preview(path, planned, monitor)
