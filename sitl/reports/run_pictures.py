"""The pictures of one run: its chart, figures over time, innovations, sonar echoes."""

import math
from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mission_tools.drawing.draw import draw_chart, draw_picture
from mission_tools.drawing.style import FAULT, HALO, INK, PLANNED, SAILED, new_figure, style_panel
from sitl.reports.run_record import Numbers, RunRecord
from sitl.reports.run_series import (
    at_estimates,
    brakes,
    cross_track_errors_m,
    fault_spans,
    mode_spans,
    wrapped_deg,
)

LEFT, RIGHT = "#b5651d", "#2a7f62"
ESTIMATED = "#d08a2e"
_SIDES = (("left", LEFT), ("right", RIGHT))
_MODE_TINTS = ("#eef3f7", "#f7f0e2", "#eaf3ea", "#f6e9ee", "#eeeaf6")
_MOST_DRAWN = 4000
_MAP_ASPECT = 1.3

_BRAKE = "#e07a1f"


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
        ("current, m/s", _current),
        ("position error\nof the estimate, m", _position_error),
        ("pack", _pack),
    ]
    figure = new_figure(12.0, 2.05 * len(panels) + 0.6)
    columns = figure.subplots(len(panels), 1, sharex=True)
    for axes, (label, draw) in zip(columns, panels, strict=True):
        draw(axes, record)
        _modes(axes, record)
        axes.set_ylabel(label, fontsize=9.5, color=INK)
        style_panel(axes)
    _mark_brakes(columns[2], record)
    _mark_brakes(columns[3], record)
    _name_spans(columns[0], mode_spans(record), 1.0, INK)
    _name_spans(columns[0], fault_spans(record), 0.0, FAULT)
    columns[-1].set_xlabel("time since boot, s", fontsize=9.5)
    times = record.truth["time_s"]
    columns[-1].set_xlim(times[0], max(times[-1], times[0] + 1.0))
    return figure


def draw_sonar_map(record: RunRecord) -> Figure | None:
    """Every echo where the boat took it to be, over the true chart; None where nothing was heard."""
    if not len(record.echoes):
        return None
    figure = new_figure(9.6, 7.2, dpi=125)
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


def _line(
    axes: Axes, times: Numbers, values: Numbers, colour: str, label: str = "", width: float = 1.1
) -> None:
    """A line with at most about _MOST_DRAWN points."""
    every = max(1, len(times) // _MOST_DRAWN)
    axes.plot(times[::every], values[::every], color=colour, linewidth=width, label=label)


def _cross_track(axes: Axes, record: RunRecord) -> None:
    axes.axhline(0.0, color="#999999", linewidth=0.8)
    _line(axes, record.truth["time_s"], cross_track_errors_m(record), SAILED)


def _heading_error(axes: Axes, record: RunRecord) -> None:
    estimates = record.estimates
    heading = at_estimates(record, np.unwrap(record.truth["heading_rad"]))
    axes.axhline(0.0, color="#999999", linewidth=0.8)
    for name, colour, label in (
        ("demand_heading_rad", PLANNED, "demand"),
        ("heading_rad", ESTIMATED, "estimate"),
    ):
        _line(axes, estimates["time_s"], wrapped_deg(estimates[name] - heading), colour, f"{label} − truth")


def _speed(axes: Axes, record: RunRecord) -> None:
    truth, estimates = record.truth, record.estimates
    over_ground = np.hypot(truth["north_m_s"], truth["east_m_s"])
    _line(axes, truth["time_s"], over_ground, SAILED, "over ground")
    _line(axes, truth["time_s"], truth["surge_m_s"], "#7fa6c4", "through water")
    _line(axes, estimates["time_s"], estimates["demand_speed_m_s"], PLANNED, "demand")


def _commands(axes: Axes, record: RunRecord) -> None:
    for side, colour in _SIDES:
        _line(axes, record.estimates["time_s"], record.estimates[side], colour, side, 0.9)
    axes.set_ylim(-1.08, 1.08)


def _thrust(axes: Axes, record: RunRecord) -> None:
    for side, colour in _SIDES:
        _line(axes, record.truth["time_s"], record.truth[f"{side}_thrust_n"], colour, side, 0.9)


def _current(axes: Axes, record: RunRecord) -> None:
    """The true current, and the boat's estimate of it, which includes the leeway."""
    for word, true_colour, colour in (("north", "#98b3c6", "#31688e"), ("east", "#c4a6bc", "#8a4f7d")):
        name = f"current_{word}_m_s"
        _line(axes, record.truth["time_s"], record.truth[name], true_colour, word, 1.6)
        _line(axes, record.estimates["time_s"], record.estimates[name], colour, f"{word}, estimated")


def _position_error(axes: Axes, record: RunRecord) -> None:
    estimates = record.estimates
    north = estimates["north_m"] - at_estimates(record, record.truth["north_m"])
    east = estimates["east_m"] - at_estimates(record, record.truth["east_m"])
    two_sigma = 2.0 * math.sqrt(2.0) * estimates["position_sigma_m"]
    axes.fill_between(
        estimates["time_s"], 0.0, two_sigma, color=ESTIMATED, alpha=0.25, linewidth=0, label="2 σ, estimated"
    )
    _line(axes, estimates["time_s"], np.hypot(north, east), SAILED, "error")
    axes.set_ylim(bottom=0.0)


def _pack(axes: Axes, record: RunRecord) -> None:
    for name, colour, label in (("voltage_v", SAILED, "V"), ("current_a", LEFT, "A")):
        _line(axes, record.truth["time_s"], record.truth[name], colour, label)
    axes.set_ylim(bottom=0.0)


def _modes(axes: Axes, record: RunRecord) -> None:
    """Bands of the modes and of faults, and a line at each waypoint."""
    for number, (begin_s, end_s, _) in enumerate(mode_spans(record)):
        axes.axvspan(begin_s, end_s, color=_MODE_TINTS[number % len(_MODE_TINTS)], zorder=0, linewidth=0)
    for begin_s, end_s, _ in fault_spans(record):
        axes.axvspan(begin_s, end_s, color=FAULT, alpha=0.09, zorder=0.5, linewidth=0)
        axes.axvline(begin_s, color=FAULT, linewidth=1.3)
    for event in record.events:
        if event.kind == "waypoint":
            axes.axvline(event.time_s, color="#9a9482", linewidth=0.7, linestyle="-", alpha=0.6)


def _name_spans(axes: Axes, spans: list[tuple[float, float, str]], height: float, colour: str) -> None:
    for begin_s, _, name in spans:
        axes.annotate(
            name, (begin_s, height), xycoords=("data", "axes fraction"), xytext=(3, 3),
            textcoords="offset points", fontsize=8.5, color=colour, annotation_clip=True,
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
        axes.plot(*at, "X", ms=10, mfc=FAULT, mec="white", mew=0.9, zorder=16)
        axes.annotate(
            name, at, xytext=(9, 6), textcoords="offset points", fontsize=9, color=FAULT, path_effects=HALO,
            zorder=16, annotation_clip=True,
        )  # fmt: skip


_BAND = 1.96  # standard deviations: 95 %
_MOST = 6.0
_REJECTED = FAULT
_PANELS = (
    ("position", (("north", "#31688e"), ("east", "#8a4f7d"))),
    ("velocity", (("north", "#31688e"), ("east", "#8a4f7d"))),
    ("compass", (("", "#31688e"),)),
)
_HYPOTHESES = (("compass", "#31688e"), ("gyro", "#2a7f62"), ("gnss", "#8a4f7d"))


def draw_innovations(record: RunRecord) -> Figure | None:
    """A panel for each sensor, and the hypotheses below; None without innovations, as in older records."""
    estimates = record.estimates
    if "position_north_nu" not in estimates or np.isnan(estimates["position_north_nu"]).all():
        return None
    figure = new_figure(12.0, 8.4)
    *columns, last = figure.subplots(len(_PANELS) + 1, 1, sharex=True)
    for axes, (sensor, components) in zip(columns, _PANELS, strict=True):
        _innovations(axes, estimates, sensor, components)
        axes.set_ylabel(f"{sensor}, σ", fontsize=9.5, color=INK)
    for name, colour in _HYPOTHESES:
        last.plot(estimates["time_s"], estimates[f"wrong_{name}"], color=colour, linewidth=1.2, label=name)
    last.set_ylim(-0.03, 1.03)
    last.set_ylabel("probability\nof being wrong", fontsize=9.5, color=INK)
    last.set_xlabel("time since boot, s", fontsize=9.5)
    for axes in (*columns, last):
        for begin_s, end_s, _ in fault_spans(record):
            axes.axvspan(begin_s, end_s, color=_REJECTED, alpha=0.09, linewidth=0)
        style_panel(axes, marker_scale=3.0)
    return figure


def _innovations(
    axes: Axes, estimates: dict[str, Numbers], sensor: str, components: tuple[tuple[str, str], ...]
) -> None:
    times, rejected = estimates["time_s"], estimates[f"rejected_{sensor}"] > 0.0
    axes.axhspan(-_BAND, _BAND, color="#eaf3ea", zorder=0, linewidth=0)
    axes.axhline(0.0, color="#999999", linewidth=0.8)
    for component, colour in components:
        values = np.clip(
            estimates[f"{sensor}_{component}_nu" if component else f"{sensor}_nu"], -_MOST, _MOST
        )
        fresh = np.concatenate(([True], np.diff(values) != 0.0))  # each innovation once
        good, bad = fresh & ~rejected, fresh & rejected
        share = np.mean(np.abs(values[good & ~np.isnan(values)]) < _BAND) if good.any() else 0.0
        label = f"{component or sensor}: {100.0 * share:.0f} % in the band"
        axes.plot(times[good], values[good], ".", ms=4.0, mec="none", mfc=colour, alpha=0.75, label=label)
        axes.plot(times[bad], values[bad], "x", ms=4.0, color=_REJECTED, mew=0.9)
    axes.set_ylim(-_MOST - 0.3, _MOST + 0.3)
