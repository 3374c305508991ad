"""The picture of a mission: its map, its plan and, after a run, the track."""

from pathlib import Path

from companion.core.geo import path_length_m
from mission_tools.mission.planned_mission import PlannedMission
from mission_tools.vehicle.mission_monitor import MissionMonitor
from mission_tools.wording import distance, duration


def save_preview(path: Path, planned: PlannedMission, monitor: MissionMonitor | None) -> None:
    """Draw the planned mission and the track, if there is one.

    Raises:
        OutputError: the file cannot be written.
    """
    if path.suffix.lower() == ".html":
        from mission_tools.drawing.html import save_page  # noqa: PLC0415 - needs no matplotlib

        save_page(path, planned, monitor)
        return
    from mission_tools.drawing.draw import draw_picture, save_figure  # noqa: PLC0415 - matplotlib takes a second to import

    track = monitor.track if monitor is not None else []
    points = planned.points
    clearance_m = planned.clearance_m
    subtitle = f"{distance(path_length_m(points))} planned"
    if clearance_m > 0.0:
        subtitle += f", clearance {clearance_m:g} m"
    if monitor is not None and track:
        subtitle += f"; {distance(monitor.track_length_m)} sailed in {duration(monitor.duration_s)}"
    figure = draw_picture(
        planned.chart,
        points,
        track=[planned.chart.frame.to_local(point.place) for point in track] or None,
        speeds_m_s=[point.speed_m_s for point in track] or None,
        title=planned.name,
        subtitle=subtitle,
        clearance_m=clearance_m,
    )
    save_figure(path, figure)
