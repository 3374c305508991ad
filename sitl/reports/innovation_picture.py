"""The picture of the filter's innovations, gates and hypotheses during a run."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mission_tools.drawing.style import FAULT, INK, new_figure, style_panel
from sitl.reports.run_series import fault_spans
from sitl.run.recording.run_record import Numbers, RunRecord

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
