"""A run's figures for people, for scripts and as a picture."""

import dataclasses
import json
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from companion.core.geo import Point
from mission_tools.drawing.draw import draw_picture, save_figure
from sitl.run.mission_run import MissionRun, Result
from sitl.world.world import Truth

_DRAWN = ("north_m", "east_m", "north_m_s", "east_m_s")
_MAX_DRAWN = 4000  # points of a track: more than a picture has pixels across


def as_json(result: Result) -> str:
    """One object, one key a figure."""
    return json.dumps(dataclasses.asdict(result), indent=2)


def print_table(result: Result, console: Console) -> None:
    """One figure a row."""
    table = Table(title=f"{result.scenario}, seed {result.seed}", box=None, show_header=False)
    for name, value in (
        ("mission", "completed" if result.completed else f"not completed, ends in {result.final_mode}"),
        ("waypoints reached", f"{result.waypoints_reached} of {result.waypoints}"),
        ("planned length", _metres(result.planned_length_m)),
        ("path length", _metres(result.path_length_m)),
        ("time", f"{result.time_s:.1f} s"),
        ("cross-track error, RMS", _metres(result.cross_track_rms_m)),
        ("cross-track error, largest", _metres(result.cross_track_max_m)),
        ("nearest to shore or obstacle", _metres(result.min_clearance_m)),
        ("groundings", str(result.groundings)),
        ("simulated", f"{result.sim_seconds:.1f} s at {result.real_time_factor:.0f} × real time"),
        ("state hash", result.state_hash[:16]),
    ):
        table.add_row(name, value)
    console.print(table)


def draw(mission_run: MissionRun, result: Result, path: Path, clearance_m: float = 0.0) -> None:
    """Chart, plan and true track, coloured by speed.

    Raises:
        OSError: the file cannot be written.
    """
    rows = mission_run.recorder.rows
    rows = rows[:: max(1, len(rows) // _MAX_DRAWN)]
    north_m, east_m, north_m_s, east_m_s = (rows[:, Truth._fields.index(name)] for name in _DRAWN)
    track = [Point(*at) for at in zip(north_m.tolist(), east_m.tolist(), strict=True)]
    scenario = mission_run.scenario
    figure = draw_picture(
        scenario.chart,
        mission_run.planned,
        track,
        title=scenario.title,
        subtitle=f"{result.path_length_m:.4g} m sailed in {result.time_s:.0f} s, "
        f"cross-track RMS {_metres(result.cross_track_rms_m)}",
        clearance_m=clearance_m,
        speeds_m_s=np.hypot(north_m_s, east_m_s).tolist(),
    )
    save_figure(path, figure)


def _metres(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g} m" if value < 100.0 else f"{value:.1f} m"
