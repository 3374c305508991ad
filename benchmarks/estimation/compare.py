"""Estimators of several checkouts on the same recordings, as a table."""

import math
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from benchmarks.estimation import feed
from benchmarks.estimation.errors import QUANTITIES, figures, load_replayed
from sitl.run.sensor_recorder import SensorRecording

Figures = dict[str, float]


def replay(checkout: Path, recordings: Sequence[Path], out: Path, *, is_timed: bool = True) -> None:
    """Feed recordings to the estimator of a checkout, by its own interpreter."""
    out.mkdir(parents=True, exist_ok=True)
    python = checkout / ".venv/bin/python"
    command = [python if python.exists() else sys.executable, "-P", feed.__file__, checkout, out]
    command += ["timed" if is_timed else "untimed", *recordings]
    environment = os.environ | {"PYTHONPATH": str(checkout)}
    subprocess.run([str(word) for word in command], check=True, cwd=out, env=environment)


def compare(recordings: Sequence[Path], checkouts: Sequence[Path]) -> list[dict[str, list[Figures]]]:
    """For each checkout the figures of all recordings, by case."""
    loaded = {path: SensorRecording.load(path) for path in recordings}
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for number, checkout in enumerate(checkouts):
            out = Path(folder) / str(number)
            replay(checkout, recordings, out)
            groups: dict[str, list[Figures]] = {}
            for path, recording in loaded.items():
                case = re.sub(r"_\d+$", "", path.stem)
                groups.setdefault(case, []).append(figures(recording, load_replayed(out / path.name)))
            found.append(groups)
    return found


def table(found: Sequence[dict[str, list[Figures]]]) -> str:
    """A row per case and checkout: RMS (mean square over the seeds), largest 95 %, largest error."""
    units = " | ".join(f"{name} ({unit})" for name, unit in QUANTITIES.items())
    lines = [f"| case | of | {units} | noticed, own flag, cleared (s) | false (s) | CPU (µs) |"]
    lines.append("|---" * (len(QUANTITIES) + 5) + "|")
    for case in found[0]:
        lines += [
            f"| {case if not number else ''} | {number} | {_cells(groups[case])} |"
            for number, groups in enumerate(found)
        ]
    for number, groups in enumerate(found):
        lines.append(f"| all | {number} | {_cells([run for runs in groups.values() for run in runs])} |")
    return "\n".join(lines)


def _cells(runs: Sequence[Figures]) -> str:
    cells = []
    for name in QUANTITIES:
        squares = [run[f"{name}_rms"] ** 2 for run in runs if f"{name}_rms" in run]
        if not squares:
            cells.append("–")
            continue
        rms = math.sqrt(sum(squares) / len(squares))
        most95 = max(run[f"{name}_95"] for run in runs if f"{name}_95" in run)
        most = max(run[f"{name}_max"] for run in runs if f"{name}_max" in run)
        cells.append(f"{rms:.3g}, {most95:.3g}, {most:.3g}")
    notice = [_largest(runs, name) for name in ("notice_s", "own_s", "clear_s")]
    cells.append(", ".join(notice) if any(notice) else "")
    cells.append(f"{sum(run['false_s'] for run in runs):.1f}")
    cells.append(f"{sum(run['cpu_us'] for run in runs) / len(runs):.1f}")
    return " | ".join(cells)


def _largest(runs: Sequence[Figures], name: str) -> str:
    values = [run[name] for run in runs if name in run]
    if not values:
        return ""
    missing = sum(math.isnan(value) for value in values)
    known = [value for value in values if not math.isnan(value)]
    return (f"{max(known):.1f}" if known else "never") + (f" ({missing} never)" if missing and known else "")
