"""Time and memory of a grid search against the number of cells, on water with many islands."""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy.ndimage import gaussian_filter

from benchmarks.measure import Row, alone
from companion.planning.grid import GridMap, shortest_path

PICTURE = Path("docs/pictures/grid_scale.png")
CELLS = (10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000)
_ROUNDS = 3
_SEED = 7
_ISLAND_CELLS = 6.0  # smoothing of the noise: islands of some tens of cells
_MEMORY_SIDE = 3163  # its square is 10 million


def islands(side: int, seed: int = _SEED) -> GridMap:
    """Smooth noise, one cell in four blocked, corners free."""
    noise = gaussian_filter(
        np.random.default_rng(seed).standard_normal((side, side), dtype=np.float32), _ISLAND_CELLS
    )
    free = noise > np.quantile(noise, 0.25)
    corner = min(20, side // 3)
    free[:corner, :corner] = free[-corner:, -corner:] = True
    return GridMap(free.astype(np.uint8).tobytes(), side, side)


def noise(side: int, seed: int = _SEED) -> GridMap:
    """One cell in five blocked at random: the worst case of jump points."""
    free = np.random.default_rng(seed).random((side, side), dtype=np.float32) >= 0.2
    free[0, :2] = free[-1, -2:] = True
    return GridMap(free.astype(np.uint8).tobytes(), side, side)


def scale_rows() -> list[Row]:
    """Time from a map's bytes to a path across it, by size; and a picture of it."""
    found: list[Row] = []
    best_ms = []
    for cells in CELLS:
        side = round(cells**0.5)
        grid = islands(side)
        times_ms = []
        for _ in range(_ROUNDS):
            began = time.thread_time()
            shortest_path(GridMap(grid.free, side, side), 0, side * side - 1)
            times_ms.append((time.thread_time() - began) * 1e3)
        found.append(
            alone(f"shortest path across {side} × {side} cells, map included", "ms", "less", times_ms)
        )
        best_ms.append(min(times_ms))
    _draw(best_ms)
    return found


def memory_row() -> Row:
    """Growth of resident memory and CPU time for 10 million cells in a process of its own."""
    done = subprocess.run([sys.executable, "-m", __name__], capture_output=True, text=True, check=True)
    peak_mb, cpu_s = map(float, done.stdout.split())
    note = f"{cpu_s:.2f} CPU s, map included; one cell in five blocked at random"
    return alone(f"peak memory of a path across {_MEMORY_SIDE}² cells", "MB", "less", [peak_mb], note)


def _draw(best_ms: list[float]) -> None:
    figure = Figure(figsize=(7.0, 4.2), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(1, 1, 1)
    axes.loglog(CELLS, best_ms, "o-")
    axes.set(xlabel="cells", ylabel="CPU ms", title="A path across a grid with many islands")
    axes.grid(which="both", alpha=0.3)
    PICTURE.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(PICTURE)


def _status_mb(key: str) -> float:
    for line in Path("/proc/self/status").read_text(encoding="ascii").splitlines():
        if line.startswith(key):
            return int(line.split()[1]) * 1024 / 1e6
    raise ValueError(f"no {key} in /proc/self/status")


def _measure_memory() -> None:
    grid = noise(_MEMORY_SIDE)
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # forgets the peak
    before_mb = _status_mb("VmRSS")
    began = time.thread_time()
    shortest_path(grid, 0, _MEMORY_SIDE**2 - 1)
    cpu_s = time.thread_time() - began
    sys.stdout.write(f"{_status_mb('VmHWM') - before_mb:.1f} {cpu_s:.3f}\n")


if __name__ == "__main__":
    _measure_memory()
