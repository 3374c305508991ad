"""Does a boat that is watched from ashore pass an obstacle that no chart has? Ten seeds, one picture."""

import statistics
import tempfile
from pathlib import Path

from benchmarks.measure import Row, alone
from benchmarks.planning.watched_run import SailedWatched, sail_watched
from companion.core.geo import Point, distance_m, path_length_m

ROUTE = (Point(0.0, 0.0), Point(0.0, 60.0))
RAFT = ((30.0, -1.5, 1.0), (30.0, 0.0, 1.0), (30.0, 1.5, 1.0))
SEEDS = range(101, 111)
PICTURE = Path("docs/pictures/watched.png")


def rows() -> list[Row]:
    """How soon the remainder is on board; the note says how many arrive, and how many touch."""
    with tempfile.TemporaryDirectory() as folder:
        runs = [sail_watched(Path(folder), ROUTE, RAFT, seed) for seed in SEEDS]
    draw(runs, PICTURE)
    arrived, touched = (sum(run.completed for run in runs), sum(bool(run.touched) for run in runs))
    longer = statistics.median(map(_longer, runs))
    note = f"{arrived} of {len(runs)} arrive, {touched} touch; {longer:.2f} × the straight way"
    took_s = [took for run in runs for _, took in run.uploads]
    return [alone("from the sight of an uncharted raft to the new mission on board", "s", took_s, note)]


def _longer(run: SailedWatched) -> float:
    return path_length_m(run.track) / distance_m(*ROUTE)


def draw(runs: list[SailedWatched], path: Path) -> None:
    """Raft, sight of the boats, and the tracks."""
    from matplotlib.figure import Figure  # noqa: PLC0415  only for the picture
    from matplotlib.patches import Circle  # noqa: PLC0415

    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    axes = figure.subplots()
    for run in runs:
        axes.plot([at.east_m for at in run.track], [at.north_m for at in run.track], lw=1.2, color="#1f6f8b")
    for east, north, radius in RAFT:
        axes.add_patch(Circle((east, north), radius, color="#b5483a"))
    axes.plot([0.0, 60.0], [0.0, 0.0], ls="--", lw=1.0, color="#888888", label="mission")
    axes.plot([], [], color="#1f6f8b", label=f"{len(runs)} boats")
    axes.plot([], [], "o", color="#b5483a", label="raft that the chart does not have")
    axes.set(xlabel="east, m", ylabel="north, m", aspect="equal", title="mission-upload --watch")
    longest = statistics.median(_longer(run) for run in runs)
    axes.text(0.99, 0.02, f"median way {longest:.2f} × straight", transform=axes.transAxes, ha="right")
    axes.legend(loc="upper left", frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
