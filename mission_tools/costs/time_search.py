"""The cheapest path over a lattice in a current that changes with time.

Delta-stepping (Meyer and Sanders, J. Algorithms 49, 2003): labels are corrected in bands as wide as the
cheapest step, all nodes of a band at once. A step that cannot be stemmed is tried again later: with waiting
allowed the network is FIFO even where currents close it for a while (Orda and Rom 1990), so one label a node
finds the earliest arrival. (Where it cannot hold its place, it leaves later: see `cheapest.py`.) By charge a
label keeps the time at which its least charge is there, and nothing waits: that is good, not always least.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mission_tools.costs.travel import Travel
from mission_tools.planning.astar import walk_back
from mission_tools.planning.grid import Grid

WAIT_STEP_S, WAIT_SHARE = 60.0, 0.02
"""How soon a step is tried again, at least, and as a share of what has been waited."""
LONGEST_WAIT_S = 18.0 * 3600.0
"""At one place: a tide and a half, so that a strait that is open in each tide is found open."""


def cheapest_cells(
    grid: Grid, travel: Travel, steps: Sequence[tuple[int, int]], first: int, last: int, depart_s: float
) -> tuple[tuple[int, ...], float] | None:
    """The path and its arrival, waits included; None if there is none. steps: rows and columns."""
    rows, columns = grid.free.shape
    east, north = grid.centres()
    up, right = np.array(steps).T
    course = np.arctan2(right, up).astype(np.float64)
    length_m = grid.cell_m * np.hypot(up, right)
    size = rows * columns
    cost, time_s, due = (np.full(size, np.inf) for _ in range(3))
    before = np.full(size, -1, dtype=np.intp)
    cost[first], time_s[first], due[first] = 0.0, depart_s, 0.0
    width = math.inf
    while due.min() < cost[last]:
        band: NDArray[np.intp] = np.flatnonzero(due <= due.min() + (width if width < math.inf else 0.0))
        row, column = band[:, np.newaxis] // columns, band[:, np.newaxis] % columns
        waited_s = due[band] - cost[band]
        now_s = np.broadcast_to((time_s[band] + waited_s)[:, np.newaxis], (len(band), len(steps)))
        to_row, to_column = row + up, column + right
        is_inside = (to_row >= 0) & (to_row < rows) & (to_column >= 0) & (to_column < columns)
        heads = np.where(is_inside, to_row * columns + to_column, first)
        can = is_inside & grid.free.ravel()[heads]
        place = north[row] + 0.5 * grid.cell_m * up, east[column] + 0.5 * grid.cell_m * right
        courses = np.broadcast_to(course, now_s.shape)
        step = travel.per_m(*place, courses, now_s) * length_m
        seconds = step if travel.pace is travel else travel.pace.per_m(*place, courses, now_s) * length_m
        is_open = np.isfinite(step)
        width = min(width, step[can & is_open].min(initial=math.inf))
        found = np.where(can, due[band][:, np.newaxis] + step, np.inf)
        better = found < cost[heads] - 1e-9
        is_barred = (can & ~is_open & (cost[heads] > due[band][:, np.newaxis])).any(axis=1)
        due[band] = np.inf
        if travel.unit == "s" and is_barred.any():
            waits = is_barred & (waited_s < LONGEST_WAIT_S)
            step_s = np.maximum(WAIT_STEP_S, WAIT_SHARE * waited_s[waits])
            due[band[waits]] = cost[band[waits]] + waited_s[waits] + step_s
        tail, which = np.nonzero(better)
        # Of several to one head the last stays
        dearest_first = np.argsort(-found[tail, which], kind="stable")
        tail, which = tail[dearest_first], which[dearest_first]
        head = heads[tail, which]
        cost[head] = due[head] = found[tail, which]
        time_s[head] = now_s[tail, which] + seconds[tail, which]
        before[head] = band[tail]
    if not math.isfinite(cost[last]):
        return None
    return walk_back(before, first, last), float(time_s[last])
