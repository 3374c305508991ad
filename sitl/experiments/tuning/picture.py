"""A search for gains as a picture: the cost of every set of gains, and of the best one on other seeds."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from companion.cli.output_file import output_file
from mission_tools.drawing.style import new_figure
from sitl.experiments.tuning.search import GainComparison, Ranking

_MOST_SHOWN = 3.0  # higher costs are drawn at the upper edge


def draw_search(rankings: Sequence[Ranking], verdict: GainComparison, title: str, path: Path) -> None:
    """Write it as PNG."""
    figure = new_figure(8.0, 4.5)
    axes = figure.subplots()
    places = range(1, len(rankings) + 1)
    for place, ranking in zip(places, rankings, strict=True):
        shown = [min(ratio, _MOST_SHOWN) for ratio in ranking.ratios]
        axes.plot([place] * len(shown), shown, "o", color=f"C{ranking.round - 1}", alpha=0.5, markersize=5)
    axes.plot(places, [ranking.ratios[0] for ranking in rankings], "-", color="0.3", label="best")
    axes.errorbar(
        [len(rankings) + 1],
        [verdict.ratio],
        yerr=[verdict.uncertainty],
        fmt="s",
        color="k",
        capsize=4,
        label="best on other seeds",
    )
    axes.axhline(1.0, color="0.6", linestyle="--", label="baseline: the boat's own gains")
    axes.set_yscale("log")
    axes.set_yticks([0.5, 0.7, 1.0, 1.5, 2.0], ["0.5", "0.7", "1", "1.5", "2"])
    axes.set_ylim(top=1.05 * _MOST_SHOWN)
    axes.minorticks_off()
    axes.set_xticks([*places, len(rankings) + 1], [*_labels(rankings), "check"])
    axes.tick_params(axis="x", rotation=45)
    axes.set_ylabel("cost relative to baseline")
    axes.set_title(title)
    axes.legend(loc="upper right")
    with output_file(path) as aside:
        figure.savefig(aside, dpi=110)


def _labels(rankings: Sequence[Ranking]) -> list[str]:
    """A round and which of its comparisons: each sails the better half of the one before on more seeds."""
    counts: Counter[int] = Counter()
    labels = []
    for ranking in rankings:
        counts[ranking.round] += 1
        labels.append(f"round {ranking.round}.{counts[ranking.round]}")
    return labels
