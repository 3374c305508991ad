"""Judge the estimator by NEES and NIS, averaged over random runs."""

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from benchmarks.estimation import consistency
from benchmarks.estimation.consistency import GROUPS, ROW_HZ, SETTLED_S, Average
from mission_tools.drawing.style import INK, new_figure, style_panel

_COLOURS = ("#31688e", "#d08a2e", "#2a7f62", "#8a4f7d")


def draw_nees(found: Mapping[str, Mapping[str, Average]], path: Path) -> None:
    """A panel for each group, a line for each campaign by title, and the 95 % bounds of the first."""
    names = [name for name in GROUPS if any(name in averages for averages in found.values())]
    figure = new_figure(11.0, 2.3 * len(names) + 0.5, dpi=100)
    columns = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    for axes, name in zip(columns, names, strict=True):
        shown = [(title, averages[name]) for title, averages in found.items() if name in averages]
        first = shown[0][1]
        axes.axhspan(first.low / first.freedom, first.high / first.freedom, color="#dcebdc", linewidth=0)
        axes.axhline(1.0, color="#8a8a80", linewidth=0.8)
        for (title, one), colour in zip(shown, _COLOURS, strict=False):
            times = SETTLED_S + np.arange(len(one.over_time)) / ROW_HZ
            share = (
                f"{100.0 * one.within_share:.0f} % of the time within, {100.0 * one.above_share:.0f} % above"
            )
            axes.plot(
                times,
                one.over_time / one.freedom,
                color=colour,
                linewidth=1.2,
                label=f"{title} ({one.runs} runs): {share}",
            )
        axes.set_ylim(0.0, max(2.0, *(1.1 * float(one.over_time.max()) / one.freedom for _, one in shown)))
        axes.set_ylabel(f"{name}\nNEES ÷ {first.freedom}", fontsize=9.5, color=INK)
        style_panel(axes)
    columns[-1].set_xlabel("time since boot, s", fontsize=9.5)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)


def main(arguments: list[str]) -> int:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.estimation", description=__doc__)
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--png", type=Path, help="draw the NEES over time")
    chosen = parser.parse_args(arguments)
    seeds = range(chosen.first_seed, chosen.first_seed + chosen.runs)
    found = {
        f"{hull} hull, receiver {receiver}": consistency.campaign(seeds, hull, receiver)
        for receiver in consistency.RECEIVERS
        for hull in ("known", "other")
    }
    print(consistency.table(found))  # noqa: T201
    if chosen.png is not None:
        alone = {title: nees for title, (nees, _) in found.items() if title.endswith("standalone")}
        draw_nees(alone, chosen.png)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
