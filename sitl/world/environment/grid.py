"""A current from a file: velocities on a grid, and at times if there is more than one."""

from bisect import bisect_right
from pathlib import Path

import numpy as np

from mission_tools.costs.current_file import read_current_table


class Grid:
    """Velocities on a rectangular grid, and at times if there is more than one; outside it as at its edge.

    In between they are linear. velocities[i][j][k] is (north, east) at times_s[i], norths_m[j], easts_m[k].
    """

    def __init__(
        self,
        times_s: list[float],
        norths_m: list[float],
        easts_m: list[float],
        velocities: list[list[list[tuple[float, float]]]],
    ) -> None:
        self._times_s, self._norths_m, self._easts_m = times_s, norths_m, easts_m
        self._velocities = velocities

    def at(self, north_m: float, east_m: float, time_s: float) -> tuple[float, float]:
        """North and east velocity."""
        when, later = _piece(self._times_s, time_s)
        row, up = _piece(self._norths_m, north_m)
        column, right = _piece(self._easts_m, east_m)
        north_m_s = east_m_s = 0.0
        for i, output_at in ((when, 1.0 - later), (when + 1, later)):
            for j, in_north in ((row, 1.0 - up), (row + 1, up)):
                for k, in_east in ((column, 1.0 - right), (column + 1, right)):
                    weight = output_at * in_north * in_east
                    if weight > 0.0:
                        north, east = self._velocities[i][j][k]
                        north_m_s += weight * north
                        east_m_s += weight * east
        return north_m_s, east_m_s


def _piece(marks: list[float], value: float) -> tuple[int, float]:
    """The piece between two marks that holds a value, and how far along it lies, 0..1."""
    last = len(marks) - 1
    if last == 0 or value <= marks[0]:
        return 0, 0.0
    if value >= marks[last]:
        return last - 1, 1.0
    piece = bisect_right(marks, value) - 1
    return piece, (value - marks[piece]) / (marks[piece + 1] - marks[piece])


def read_grid(path: Path) -> Grid:
    """Read a current in metres of the scenario's frame (see `mission_tools.costs.current_file`).

    Where its times are dates, the emulator begins at the first.

    Raises ConfigError: the file cannot be read, or is not such a grid; it says what is wrong.
    """
    table = read_current_table(path)
    pairs = np.stack([table.current_north_m_s, table.current_east_m_s], axis=-1).tolist()
    velocities = [[[(north, east) for north, east in row] for row in sheet] for sheet in pairs]
    begin_s = table.time_s[0] if table.is_dated else 0.0
    return Grid((table.time_s - begin_s).tolist(), table.north_m.tolist(), table.east_m.tolist(), velocities)
