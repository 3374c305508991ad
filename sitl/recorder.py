"""What a run was like: the truth of every tick, and the figures that come out of it."""

import csv
import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from companion.geo import Point
from sitl.shore import Shore
from sitl.world import Truth

NO_LEG = -1


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
    """Keeps every tick in memory: about 200 bytes a tick, 36 MB an hour at 50 Hz."""

    __slots__ = ("_legs", "_rows")

    def __init__(self) -> None:
        """Start empty."""
        self._rows: list[Truth] = []
        self._legs: list[int] = []

    def __len__(self) -> int:
        """How many ticks were recorded."""
        return len(self._rows)

    def record(self, truth: Truth, leg: int = NO_LEG) -> None:
        """Keep one tick; leg i leads from planned point i to i + 1, negative is no leg."""
        self._rows.append(truth)
        self._legs.append(leg)

    def track(self) -> list[Point]:
        """Where the boat was, tick by tick."""
        return [Point(row.north_m, row.east_m) for row in self._rows]

    def cross_track_m(self, planned: Sequence[Point]) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
        """Signed distance to the active leg's line at each tick that had one; starboard of it is positive.

        Raises:
            ValueError: a recorded leg is not in the plan.
        """
        legs = np.asarray(self._legs, dtype=np.int64)
        sailed = legs >= 0
        if not sailed.any():
            return np.empty(0)
        if int(legs.max()) > len(planned) - 2:
            raise ValueError(f"leg {int(legs.max())} was recorded, but the plan has {len(planned)} points")
        points = np.asarray(planned, dtype=np.float64)
        at = np.asarray([row[1:3] for row in self._rows], dtype=np.float64)[sailed]
        start = points[legs[sailed]]
        along = points[legs[sailed] + 1] - start
        off = at - start
        length = np.hypot(along[:, 0], along[:, 1])
        cross = along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]
        # On a leg without length the only error there is is the distance to its point.
        out: np.ndarray[tuple[int], np.dtype[np.float64]] = np.where(
            length > 0.0, cross / np.where(length > 0.0, length, 1.0), np.hypot(off[:, 0], off[:, 1])
        )
        return out

    def metrics(self, planned: Sequence[Point], shore: Shore) -> TrackMetrics:
        """The figures of the run so far.

        Raises:
            ValueError: nothing was recorded, or a recorded leg is not in the plan.
        """
        if not self._rows:
            raise ValueError("nothing was recorded")
        at = np.asarray([row[1:3] for row in self._rows], dtype=np.float64)
        cross = self.cross_track_m(planned)
        clearance = min(shore.clearances_m(at[:, 1].tolist(), at[:, 0].tolist()))
        aground = [row.grounded for row in self._rows]
        return TrackMetrics(
            time_s=self._rows[-1].time_s - self._rows[0].time_s,
            path_length_m=float(np.hypot(*np.diff(at, axis=0).T).sum()),
            cross_track_rms_m=math.sqrt(float(np.mean(cross * cross))) if len(cross) else None,
            cross_track_max_m=float(np.abs(cross).max()) if len(cross) else None,
            min_clearance_m=None if math.isinf(clearance) else clearance,
            groundings=sum(
                now and not before for before, now in zip([False, *aground], aground, strict=False)
            ),
        )

    def state_hash(self) -> str:
        """SHA-256 over every number of every tick, as little-endian doubles: equal runs, equal hash."""
        rows = np.asarray(self._rows, dtype="<f8")
        return hashlib.sha256(rows.tobytes() + np.asarray(self._legs, dtype="<i8").tobytes()).hexdigest()

    def write_csv(self, path: Path, every: int = 1) -> None:
        """Write the trajectory, every n-th tick, one column per field of Truth and the leg.

        Raises:
            OSError: the file cannot be written.
        """
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow((*Truth._fields, "leg"))
            for row, leg in zip(self._rows[::every], self._legs[::every], strict=True):
                writer.writerow((*(f"{value:.6f}" for value in row[:-1]), int(row.grounded), leg))
