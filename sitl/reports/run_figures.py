"""A run's figures for people and for scripts."""

import dataclasses
import json

from rich.console import Console
from rich.table import Table

from sitl.run.mission_run import Result


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


def _metres(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g} m" if value < 100.0 else f"{value:.1f} m"
