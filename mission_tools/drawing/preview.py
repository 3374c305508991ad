"""The picture of a mission: its map, its plan and, after a run, the track."""

from pathlib import Path
from typing import TYPE_CHECKING

from companion.cli.output_file import write_text
from companion.core.geo import path_length_m
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.vehicle.mission_monitor import MissionMonitor
from mission_tools.wording import distance, duration

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def save_preview(path: Path, planned: PlannedMission, monitor: MissionMonitor | None = None) -> None:
    """Draw the planned mission, and the track if there is one. Raises OutputError: cannot be written."""
    if path.suffix.lower() == ".html":
        from mission_tools.drawing.html import compose  # noqa: PLC0415 - needs no matplotlib

        write_text(path, compose(planned, monitor))
        return
    from mission_tools.drawing.draw import save_figure  # noqa: PLC0415 - matplotlib takes a second to import

    save_figure(path, figure_of(planned, monitor))


def figure_of(planned: PlannedMission, monitor: MissionMonitor | None = None) -> "Figure":
    """The picture of the planned mission and of the track, if there is one; a survey's has its coverage."""
    from mission_tools.drawing.draw import draw_picture, draw_survey  # noqa: PLC0415 - matplotlib is slow

    sailed = monitor.track if monitor is not None else []
    track = [planned.chart.frame.to_local(point.place) for point in sailed] or None
    title, subtitle = planned.name, _subtitle(planned, monitor)
    if planned.survey is not None:
        survey, parts = planned.survey, planned.parts
        return draw_survey(planned.chart, survey, track, title=title, subtitle=subtitle, parts=parts)
    return draw_picture(
        planned.chart,
        planned.points or None,
        track=track,
        speeds_m_s=[point.speed_m_s for point in sailed] or None,
        title=title,
        subtitle=subtitle,
        clearance_m=planned.clearance_m,
        parts=planned.parts,
    )


def _subtitle(planned: PlannedMission, monitor: MissionMonitor | None) -> str:
    """How long and how near."""
    if not planned.points:
        return ""
    said = f"{distance(path_length_m(planned.points))} planned"
    if planned.clearance_m > 0.0:
        said += f", clearance {planned.clearance_m:g} m"
    if planned.survey is not None:
        survey = planned.survey
        said += f"; lines {distance(survey.spacing_m)} apart"
        said += f", {100.0 * survey.coverage:.1f} % covered"
    if planned.timetable is not None:
        said += f"; {planned.timetable.span}"
    if monitor is not None and monitor.track:
        said += f"; {distance(monitor.track_length_m)} sailed in {duration(monitor.duration_s)}"
    return said
