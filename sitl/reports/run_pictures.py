"""The pictures of one run: its chart, its figures over time, what the sonar heard."""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from companion.core.modes import Mode
from mission_tools.drawing.draw import draw_chart, draw_picture
from mission_tools.drawing.legend import HALO, INK, PAPER, PLANNED, SAILED
from sitl.run.run_record import RunRecord
from sitl.run.timeline import OVER

Numbers = NDArray[np.float64]

LEFT, RIGHT = "#b5651d", "#2a7f62"
BELIEVED = "#d08a2e"
_MODE_TINTS = ("#eef3f7", "#f7f0e2", "#eaf3ea", "#f6e9ee", "#eeeaf6")
_MOST_DRAWN = 4000
_MAP_ASPECT = 1.3
_FAULT = "#b3261e"
_BRAKE = "#e07a1f"
_ASTERN = 0.1  # of full command: less is the dead band of a boat that keeps its place
_MOVING_M_S = 0.1
_ONE_BRAKE_S = 1.0  # motors that go astern again within this go on with the same brake


def draw_track_chart(record: RunRecord) -> Figure:
    """Chart, plan and true track, coloured by speed."""
    track = record.track
    every = max(1, len(track) // _MOST_DRAWN)
    speeds = np.hypot(record.truth["north_m_s"], record.truth["east_m_s"])[::every]
    result = record.result
    figure = draw_picture(
        record.chart,
        record.planned or None,
        track[::every],
        title=str(result["scenario"]),
        subtitle=f"seed {result['seed']}: {result['path_length_m']:.4g} m sailed in {result['time_s']:.0f} s",
        clearance_m=record.clearance_m,
        speeds_m_s=speeds.tolist(),
    )
    _mark_track(figure.axes[0], record)
    return figure


def draw_panels(record: RunRecord) -> Figure:
    """Everything that is worth seeing over time, on one axis of time, the modes as bands behind it."""
    panels: list[tuple[str, Callable[[Axes, RunRecord], None]]] = [
        ("cross-track error, m", _cross_track),
        ("heading error, °", _heading_error),
        ("speed, m/s", _speed),
        ("command", _commands),
        ("thrust, N", _thrust),
        ("carried by water\nand wind, m/s", _current),
        ("position error\nof the estimate, m", _position_error),
        ("pack", _pack),
    ]
    figure = Figure(figsize=(12.0, 2.05 * len(panels) + 0.6), facecolor=PAPER, layout="constrained")
    FigureCanvasAgg(figure)
    columns = figure.subplots(len(panels), 1, sharex=True)
    for axes, (label, draw) in zip(columns, panels, strict=True):
        axes.set_facecolor("white")
        draw(axes, record)
        _modes(axes, record)
        axes.set_ylabel(label, fontsize=9.5, color=INK)
        axes.grid(color="#d8d2c4", linewidth=0.6)
        axes.tick_params(labelsize=8.5)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(
                loc="lower right",
                bbox_to_anchor=(1.0, 0.98),
                fontsize=8,
                ncols=4,
                frameon=False,
                borderpad=0.1,
            )
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    _mark_brakes(columns[2], record)
    _mark_brakes(columns[3], record)
    _name_modes(columns[0], record)
    _name_faults(columns[0], record)
    columns[-1].set_xlabel("time since boot, s", fontsize=9.5)
    times = record.truth["time_s"]
    columns[-1].set_xlim(times[0], max(times[-1], times[0] + 1.0))
    return figure


def draw_sonar_map(record: RunRecord) -> Figure | None:
    """Every echo where the boat took it to be, over the true chart; None where nothing was heard."""
    if not len(record.echoes):
        return None
    figure = Figure(figsize=(9.6, 7.2), dpi=125, facecolor=PAPER, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    draw_chart(axes, record.chart)
    north_m, east_m = record.truth["north_m"], record.truth["east_m"]
    axes.plot(east_m, north_m, color=SAILED, linewidth=1.2, label="sailed", zorder=9)
    times_s, echo_n, echo_e = record.echoes.T
    dots = axes.scatter(
        echo_e, echo_n, c=times_s, s=9, cmap="plasma", zorder=12, label="echoes", linewidths=0
    )
    bar = figure.colorbar(dots, ax=axes, shrink=0.7, pad=0.01)
    bar.set_label("time since boot, s", fontsize=9)
    all_e, all_n = np.concatenate((east_m, echo_e)), np.concatenate((north_m, echo_n))
    middle_e, middle_n = 0.5 * (all_e.min() + all_e.max()), 0.5 * (all_n.min() + all_n.max())
    half_m = 0.56 * max(np.ptp(all_n), np.ptp(all_e) / _MAP_ASPECT, 1e-3)
    axes.set(
        xlim=(middle_e - _MAP_ASPECT * half_m, middle_e + _MAP_ASPECT * half_m),
        ylim=(middle_n - half_m, middle_n + half_m),
        aspect="equal",
        xlabel="east, m",
        ylabel="north, m",
    )
    axes.legend(loc="lower right", fontsize=9)
    return figure


def cross_track_m(record: RunRecord) -> Numbers:
    """Signed distance to the line of the leg being sailed, starboard positive; NaN without a leg."""
    out = np.full(len(record.legs), np.nan)
    if len(record.planned) < 2:
        return out
    points = np.asarray(record.planned, dtype=np.float64)
    sailed = record.legs >= 0
    legs = record.legs[sailed]
    start, along = points[legs], points[legs + 1] - points[legs]
    off = np.column_stack((record.truth["north_m"], record.truth["east_m"]))[sailed] - start
    length = np.hypot(*along.T)
    out[sailed] = (along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]) / np.where(length > 0.0, length, np.nan)
    return out


def _cross_track(axes: Axes, record: RunRecord) -> None:
    every = _every(record)
    axes.axhline(0.0, color="#999999", linewidth=0.8)
    axes.plot(record.truth["time_s"][::every], cross_track_m(record)[::every], color=SAILED, linewidth=1.2)


def _heading_error(axes: Axes, record: RunRecord) -> None:
    estimates, truth = record.estimates, record.truth
    heading = _at_estimates(record, np.unwrap(truth["heading_rad"]))
    wanted = _degrees(estimates["demand_heading_rad"] - heading)
    believed = _degrees(estimates["heading_rad"] - heading)
    axes.axhline(0.0, color="#999999", linewidth=0.8)
    axes.plot(estimates["time_s"], wanted, color=PLANNED, linewidth=1.0, label="demand − truth")
    axes.plot(estimates["time_s"], believed, color=BELIEVED, linewidth=1.0, label="estimate − truth")


def _speed(axes: Axes, record: RunRecord) -> None:
    every, truth = _every(record), record.truth
    over_ground = np.hypot(truth["north_m_s"], truth["east_m_s"])
    axes.plot(
        truth["time_s"][::every], over_ground[::every], color=SAILED, linewidth=1.3, label="over ground"
    )
    axes.plot(
        truth["time_s"][::every],
        truth["surge_m_s"][::every],
        color="#7fa6c4",
        linewidth=1.0,
        label="through water",
    )
    estimates = record.estimates
    axes.plot(
        estimates["time_s"], estimates["demand_speed_m_s"], color=PLANNED, linewidth=1.0, label="demand"
    )


def _commands(axes: Axes, record: RunRecord) -> None:
    estimates = record.estimates
    axes.plot(estimates["time_s"], estimates["left"], color=LEFT, linewidth=0.9, label="left")
    axes.plot(estimates["time_s"], estimates["right"], color=RIGHT, linewidth=0.9, label="right")
    axes.set_ylim(-1.08, 1.08)


def _thrust(axes: Axes, record: RunRecord) -> None:
    every, truth = _every(record), record.truth
    for side, colour in (("left", LEFT), ("right", RIGHT)):
        axes.plot(
            truth["time_s"][::every],
            truth[f"{side}_thrust_n"][::every],
            color=colour,
            linewidth=0.9,
            label=side,
        )


def _current(axes: Axes, record: RunRecord) -> None:
    """The true current, and the set that the boat estimates: the current with the leeway in it."""
    every, truth, estimates = _every(record), record.truth, record.estimates
    for word, colour in (("north", "#31688e"), ("east", "#8a4f7d")):
        true = truth[f"current_{word}_m_s"][::every]
        axes.plot(
            truth["time_s"][::every], true, color=colour, linewidth=1.6, alpha=0.55, label=f"current, {word}"
        )
        axes.plot(
            estimates["time_s"],
            estimates[f"current_{word}_m_s"],
            color=colour,
            linewidth=1.1,
            linestyle="--",
            label=f"current as estimated, {word}",
        )


def _position_error(axes: Axes, record: RunRecord) -> None:
    estimates = record.estimates
    north = estimates["north_m"] - _at_estimates(record, record.truth["north_m"])
    east = estimates["east_m"] - _at_estimates(record, record.truth["east_m"])
    two_sigma = 2.0 * math.sqrt(2.0) * estimates["position_sigma_m"]
    axes.fill_between(
        estimates["time_s"], 0.0, two_sigma, color=BELIEVED, alpha=0.25, linewidth=0, label="2 σ as estimated"
    )
    axes.plot(estimates["time_s"], np.hypot(north, east), color=SAILED, linewidth=1.2, label="error")
    axes.set_ylim(bottom=0.0)


def _pack(axes: Axes, record: RunRecord) -> None:
    every, truth = _every(record), record.truth
    axes.plot(truth["time_s"][::every], truth["voltage_v"][::every], color=SAILED, linewidth=1.1, label="V")
    axes.plot(truth["time_s"][::every], truth["current_a"][::every], color=LEFT, linewidth=0.9, label="A")
    axes.set_ylim(bottom=0.0)


def _modes(axes: Axes, record: RunRecord) -> None:
    """Bands of the modes and of faults, and a line at each waypoint."""
    for number, (begin_s, end_s, _) in enumerate(_spans(record)):
        axes.axvspan(begin_s, end_s, color=_MODE_TINTS[number % len(_MODE_TINTS)], zorder=0, linewidth=0)
    for begin_s, end_s, _ in fault_spans(record):
        axes.axvspan(begin_s, end_s, color=_FAULT, alpha=0.09, zorder=0.5, linewidth=0)
        axes.axvline(begin_s, color=_FAULT, linewidth=1.3)
    for event in record.events:
        if event.kind == "waypoint":
            axes.axvline(event.time_s, color="#9a9482", linewidth=0.7, linestyle="-", alpha=0.6)


def _name_modes(axes: Axes, record: RunRecord) -> None:
    for begin_s, _, name in _spans(record):
        axes.annotate(
            name, (begin_s, 1.0), xycoords=("data", "axes fraction"), xytext=(3, 3),
            textcoords="offset points", fontsize=8.5, color=INK, annotation_clip=True,
        )  # fmt: skip


def _name_faults(axes: Axes, record: RunRecord) -> None:
    for begin_s, _, name in fault_spans(record):
        axes.annotate(
            name, (begin_s, 0.0), xycoords=("data", "axes fraction"), xytext=(3, 3),
            textcoords="offset points", fontsize=8.5, color=_FAULT, annotation_clip=True,
        )  # fmt: skip


def _mark_brakes(axes: Axes, record: RunRecord) -> None:
    for begin_s, _ in brakes(record):
        axes.plot(
            [begin_s], [0.97], "v", transform=axes.get_xaxis_transform(), ms=5.5, mfc=_BRAKE, mec="white",
            mew=0.4, clip_on=False, zorder=8,
        )  # fmt: skip


def _mark_track(axes: Axes, record: RunRecord) -> None:
    """A triangle where the boat began to brake, a cross with its name where a fault began."""
    times = record.truth["time_s"]

    def where(time_s: float) -> tuple[float, float]:
        north_m, east_m = (float(np.interp(time_s, times, record.truth[n])) for n in ("north_m", "east_m"))
        return east_m, north_m

    for begin_s, _ in brakes(record):
        axes.plot(*where(begin_s), "v", ms=8, mfc=_BRAKE, mec="white", mew=0.8, zorder=15)
    for begin_s, _, name in fault_spans(record):
        at = where(begin_s)
        axes.plot(*at, "X", ms=10, mfc=_FAULT, mec="white", mew=0.9, zorder=16)
        axes.annotate(
            name, at, xytext=(9, 6), textcoords="offset points", fontsize=9, color=_FAULT, path_effects=HALO,
            zorder=16, annotation_clip=True,
        )  # fmt: skip


def fault_spans(record: RunRecord) -> list[tuple[float, float, str]]:
    """Begin, end and name of each fault; one that lasts ends with the run."""
    open_since: dict[str, float] = {}
    spans = []
    for event in record.events:
        if event.kind == "fault":
            name = event.text.removesuffix(OVER)
            if name == event.text:
                open_since[name] = event.time_s
            elif name in open_since:
                spans.append((open_since.pop(name), event.time_s, name))
    end_s = float(record.truth["time_s"][-1]) if len(record.truth["time_s"]) else 0.0
    spans += [(begin_s, max(end_s, begin_s), name) for name, begin_s in open_since.items()]
    return sorted(spans)


def brakes(record: RunRecord) -> list[tuple[float, float]]:
    """Begin and end of each time that both motors went astern while the boat moved ahead."""
    times = record.estimates["time_s"]
    if not len(times):
        return []
    ahead_m_s = _at_estimates(record, record.truth["surge_m_s"])
    astern = np.maximum(record.estimates["left"], record.estimates["right"]) < -_ASTERN
    flags = np.concatenate(([False], astern & (ahead_m_s > _MOVING_M_S), [False])).astype(np.int8)
    begins, ends = np.flatnonzero(np.diff(flags) == 1), np.flatnonzero(np.diff(flags) == -1) - 1
    found: list[tuple[float, float]] = []
    for begin_s, end_s in zip(times[begins].tolist(), times[ends].tolist(), strict=True):
        if found and begin_s - found[-1][1] < _ONE_BRAKE_S:
            found[-1] = found[-1][0], end_s
        else:
            found.append((begin_s, end_s))
    return found


def _spans(record: RunRecord) -> list[tuple[float, float, str]]:
    """Begin, end and name of each mode."""
    times, modes = record.estimates["time_s"], record.estimates["mode"]
    if not len(times):
        return []
    changes = [0, *(np.flatnonzero(np.diff(modes)) + 1).tolist(), len(times) - 1]
    return [
        (float(times[a]), float(times[b]), Mode(int(modes[a])).name)
        for a, b in pairwise(changes)
        if b > a or len(changes) == 2
    ]


def _every(record: RunRecord) -> int:
    return max(1, len(record.legs) // _MOST_DRAWN)


def _at_estimates(record: RunRecord, column: Numbers) -> Numbers:
    """A column of the truth at the times of the estimates."""
    return np.interp(record.estimates["time_s"], record.truth["time_s"], column)


def _degrees(angle_rad: Numbers) -> Numbers:
    wrapped: Numbers = np.degrees(np.mod(angle_rad + math.pi, 2.0 * math.pi) - math.pi)
    return wrapped
