"""A fit as a picture: a segment that it has not seen, measured and simulated, and tests of its residuals.

If the model explains the voyage, its residuals are white and do not follow the commands: their correlations
lie within ±2.58 / √n at 99 of 100 lags (L. Ljung, *System Identification*, 2nd edition, 1999, section 16.6).
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from scipy.integrate import cumulative_trapezoid

from companion.cli.output_file import output_file
from mission_tools.drawing.style import PLANNED, SAILED, new_figure, style_panel
from sitl.twin.fit import Fit, following
from sitl.twin.segmented_voyage import CHANNELS
from sitl.twin.voyage import STORED_S, Floats, Voyage

_LAGS: Final = 25
_BOUND: Final = 2.58


def draw_fit(fit: Fit, rest: Voyage, path: Path) -> None:
    """Write it as PNG. rest: of a voyage, not used in the fit."""
    segments, run, nuisance = following(fit, rest)
    simulated, measured = segments.predicted(run, nuisance), segments.measured
    times_s = [one - rest.start_s for one in segments.times_s]
    figure = new_figure(11.0, 10.0)
    panels = figure.subplots(3, 2)
    speeds = [np.hypot(*one[:2]) for one in (measured, simulated)]
    rates = [np.degrees(one[2]) for one in (measured, simulated)]
    turns = [STORED_S * np.cumsum(one.reshape(segments.count, -1), axis=1).ravel() for one in rates]
    _pair(panels[0, 0], times_s[0], speeds, "speed over ground, m/s", "simulated")
    ahead = f"predicted {STORED_S:g} s ahead"  # the filter knows the gusts until then
    _pair(panels[0, 1], times_s[2], rates, "turn rate, °/s", ahead)
    _pair(panels[1, 0], times_s[2], turns, "heading since the last restart, °", ahead)
    for one, colour in ((measured, SAILED), (simulated, PLANNED)):
        north, east = (
            one[0] * segments.cos - one[1] * segments.sin,
            one[0] * segments.sin + one[1] * segments.cos,
        )
        places = [cumulative_trapezoid(axis, times_s[0], initial=0.0) for axis in (east, north)]
        panels[1, 1].plot(*places, color=colour)
    panels[1, 1].set(xlabel="east, m", ylabel="north, m", aspect="equal")
    rows, voyage = fit.residuals[0], fit.segmented[0].voyage
    for row, name in zip(rows, CHANNELS, strict=True):
        panels[2, 0].plot(
            range(1, _LAGS + 1), _correlations(row, row)[1:], ".-", label=name.partition(",")[0]
        )
    steps_s = voyage.start_s + voyage.step_s * np.arange(len(voyage.left))
    for channel, command in ((0, voyage.left + voyage.right), (2, voyage.left - voyage.right)):
        commands = np.interp(fit.segmented[0].times_s[channel], steps_s, command)
        name = CHANNELS[channel].partition(",")[0]
        panels[2, 1].plot(_correlations(rows[channel], commands), ".-", label=name)
    for panel, what in zip(panels[2], ("with earlier residuals", "with earlier commands"), strict=True):
        panel.axhspan(*(_BOUND / np.sqrt(len(rows[0])) * np.array([-1.0, 1.0])), color="0.85")
        panel.set(xlabel="lag, samples", ylabel=f"correlation {what}", ylim=(-0.4, 0.4))
    for panel in panels.flat:
        style_panel(panel)
    with output_file(path) as aside:
        figure.savefig(aside, dpi=110)


def _pair(panel: Axes, times_s: Floats, rows: Sequence[Any], name: str, other: str) -> None:
    panel.plot(times_s, rows[0], color=SAILED, linewidth=1.0, label="measured")
    panel.plot(times_s, rows[1], color=PLANNED, linewidth=1.0, label=other)
    panel.set(xlabel="s", ylabel=name)


def _correlations(row: Floats, earlier: Floats) -> Floats:
    """Normalised, over the lags 0, 1, …"""
    row, earlier = (one - one.mean() for one in (row, earlier))
    size = np.sqrt((row @ row) * (earlier @ earlier))
    return np.array([row[lag:] @ earlier[: len(row) - lag] for lag in range(_LAGS + 1)]) / size
