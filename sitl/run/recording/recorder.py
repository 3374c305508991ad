"""Ground truth of every tick of a run, and figures from it."""

import csv
import hashlib
import math
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from companion.cli.output_file import output_file
from companion.core.geo import Point
from sitl.world.shore import Shore
from sitl.world.truth import Truth

NO_LEG = -1
_FIELDS = len(Truth._fields)
_PLACE = slice(Truth._fields.index("north_m"), Truth._fields.index("east_m") + 1)
_GROUNDED = Truth._fields.index("grounded")

Rows = np.ndarray[tuple[int, int], np.dtype[np.float64]]


@dataclass(frozen=True, slots=True)
class TrackMetrics:
    """Figures of one run, all from the truth.

    Cross-track errors are distances to the straight line of the leg being sailed; None when no leg ever was.
    min_clearance_m is the centre's distance to the nearest edge of the water; None on open water.
    """

    time_s: float
    path_length_m: float
    cross_track_rms_m: float | None
    cross_track_max_m: float | None
    min_clearance_m: float | None
    groundings: int


class Recorder:
    """Keeps every tick in memory: some 20 MB an hour at 50 Hz."""

    def __init__(self) -> None:
        self._numbers = array("d")
        self._legs = array("q")

    def __len__(self) -> int:
        """How many ticks were recorded."""
        return len(self._legs)

    def record(self, truth: Truth, leg: int = NO_LEG) -> None:
        """Record one tick; leg i leads from planned point i to i + 1, negative is no leg."""
        self._numbers.extend(truth)
        self._legs.append(leg)

    @property
    def rows(self) -> Rows:
        """A copy, shape (ticks, fields of Truth); grounded is 0 or 1."""
        return np.array(self._numbers, dtype=np.float64).reshape(-1, _FIELDS)

    @property
    def legs(self) -> "np.ndarray[tuple[int], np.dtype[np.int64]]":
        """A copy of the leg of every tick."""
        return np.array(self._legs, dtype=np.int64)

    def track(self) -> list[Point]:
        """The boat's positions, tick by tick."""
        return [Point(north_m, east_m) for north_m, east_m in self.rows[:, _PLACE].tolist()]

    def cross_track_m(self, planned: Sequence[Point]) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
        """Signed distance to the active leg's line at each tick that had one; starboard of it is positive.

        Raises ValueError: a recorded leg is not in the plan.
        """
        return cross_track_m(self.rows[:, _PLACE], self.legs, planned)

    def metrics(self, planned: Sequence[Point], shore: Shore, sailed: int | None = None) -> TrackMetrics:
        """The figures of the run so far. sailed: only the first so many ticks count for time and length.

        Raises ValueError: nothing was recorded, or a recorded leg is not in the plan.
        """
        if not self._legs:
            raise ValueError("nothing was recorded")
        rows = self.rows
        at = rows[:, _PLACE]
        cross = self.cross_track_m(planned)
        clearance = min(shore.clearances_m(at[:, 1].tolist(), at[:, 0].tolist()))
        aground = rows[:, _GROUNDED] > 0.0
        return TrackMetrics(
            time_s=float(rows[:sailed][-1, 0] - rows[0, 0]),
            path_length_m=float(np.hypot(*np.diff(at[:sailed], axis=0).T).sum()),
            cross_track_rms_m=math.sqrt(float(np.mean(cross * cross))) if len(cross) else None,
            cross_track_max_m=float(np.abs(cross).max()) if len(cross) else None,
            min_clearance_m=None if math.isinf(clearance) else clearance,
            groundings=int(np.count_nonzero(aground & ~np.concatenate(([False], aground[:-1])))),
        )

    def state_hash(self) -> str:
        """SHA-256 over every number of every tick, as little-endian doubles: equal runs, equal hash."""
        digest = hashlib.sha256(self.rows.astype("<f8").tobytes())
        digest.update(self.legs.astype("<i8").tobytes())
        return digest.hexdigest()

    def write_csv(self, path: Path, every: int = 1) -> None:
        """Write the trajectory, every n-th tick, one column per field of Truth and the leg.

        Raises OutputError: the file cannot be written.
        """
        with output_file(path) as aside, aside.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow((*Truth._fields, "leg"))
            for row, leg in zip(self.rows[::every].tolist(), self.legs[::every].tolist(), strict=True):
                numbers = [f"{value:.6f}" for value in row]
                numbers[_GROUNDED] = str(int(row[_GROUNDED]))
                writer.writerow((*numbers, leg))


def cross_track_m(
    at: Rows, legs: "np.ndarray[tuple[int], np.dtype[np.int64]]", planned: Sequence[Point]
) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    """Signed distance to the line of the leg at each tick that has one; starboard is positive.

    at: north and east of every tick; legs: its leg, negative for none. Raises ValueError: a leg is not in the
    plan.
    """
    sailed = legs >= 0
    if not sailed.any():
        return np.empty(0)
    if int(legs.max()) > len(planned) - 2:
        raise ValueError(f"leg {int(legs.max())} was recorded, but the plan has {len(planned)} points")
    points = np.asarray(planned, dtype=np.float64)
    start = points[legs[sailed]]
    along, off = points[legs[sailed] + 1] - start, at[sailed] - start
    length = np.hypot(along[:, 0], along[:, 1])
    cross = along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]
    # On a leg without length the error is the distance to its point
    out: np.ndarray[tuple[int], np.dtype[np.float64]] = np.where(
        length > 0.0, cross / np.where(length > 0.0, length, 1.0), np.hypot(off[:, 0], off[:, 1])
    )
    return out
