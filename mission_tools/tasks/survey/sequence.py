"""The order in which cells are sailed, and each cell's end to begin at.

An item may be sailed in several modes, each with an entry, an exit and a length in between: a generalised
travelling salesman problem. The order starts with the nearest neighbour. It is improved by moving one item,
in any mode, by moving a few in a row, either way round (I. Or, 1976), or by reversing a stretch, the best
move first, until none shortens it.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_GAIN_M = 1e-6
_LONGEST_ROW = 4  # that is moved


class Mode(NamedTuple):
    """One way to sail an item: the nodes where it begins and ends, and the length of the transits within."""

    entry: int
    exit: int
    inner_m: float


def best_sequence(
    items: Sequence[Sequence[Mode]],
    lengths_m: Array,
    start: int,
    end: int,
    order: list[tuple[int, int]] | None = None,
) -> list[tuple[int, int]]:
    """(item, mode) in the order of sailing, from node `start` to node `end`.

    lengths_m: between nodes, symmetric. Each item has the same even number of modes; the second half are
    those of the first half, reversed. order: to begin with; None: the nearest first.
    """
    entries, exits, inner_m = (
        np.array([[mode[field] for mode in modes] for modes in items]) for field in range(3)
    )
    entries, exits = entries.astype(np.intp), exits.astype(np.intp)
    half = entries.shape[1] // 2
    order = order or _nearest_first(entries, exits, lengths_m, start)
    while True:
        moved = _best_move(order, (entries, exits, inner_m), lengths_m, (start, end), half)
        if moved is None:
            return order
        order = moved


def _nearest_first(
    entries: NDArray[np.intp], exits: NDArray[np.intp], lengths_m: Array, start: int
) -> list[tuple[int, int]]:
    left = np.ones(len(entries), dtype=bool)
    here, order = start, []
    while left.any():
        cost_m = np.where(left[:, None], lengths_m[here][entries], np.inf)
        item, mode = divmod(int(np.argmin(cost_m)), entries.shape[1])
        order.append((item, mode))
        left[item] = False
        here = int(exits[item, mode])
    return order


def _best_move(
    order: list[tuple[int, int]],
    modes: tuple[NDArray[np.intp], NDArray[np.intp], Array],
    lengths_m: Array,
    ends: tuple[int, int],
    half: int,
) -> list[tuple[int, int]] | None:
    """The order after the move that shortens it most; None where none does."""
    entries, exits, inner_m = modes
    start, end = ends
    count = len(order)
    items = np.array([item for item, _ in order])
    chosen = np.array([mode for _, mode in order])
    entry, leave = entries[items, chosen], exits[items, chosen]
    before, after = np.concatenate(([start], leave)), np.concatenate((entry, [end]))
    gap_m = lengths_m[before, after]
    bridge_m = lengths_m[before[:-1], after[1:]]
    saved_m = inner_m[items, chosen] + gap_m[:-1] + gap_m[1:] - bridge_m
    # Moved to gap g, between before[g] and after[g], in mode m.
    added_m = lengths_m[before[None, :, None], entries[items][:, None, :]]
    added_m = added_m + lengths_m[exits[items][:, None, :], after[None, :, None]]
    added_m += inner_m[items][:, None, :] - gap_m[None, :, None]
    own = np.arange(count)
    added_m[own, own] = added_m[own, own + 1] = np.inf
    stay_m = lengths_m[before[:-1][:, None], entries[items]] + lengths_m[exits[items], after[1:][:, None]]
    added_m[own, own] = stay_m + inner_m[items] - bridge_m[:, None]
    gain_m = saved_m[:, None, None] - added_m
    at = np.unravel_index(int(np.argmax(gain_m)), gain_m.shape)
    # A reversed stretch, from item i to item j.
    turned_m = gap_m[:-1, None] + gap_m[None, 1:]
    turned_m = turned_m - lengths_m[before[:-1][:, None], leave[None, :]]
    turned_m -= lengths_m[entry[:, None], after[1:][None, :]]
    turned_m[np.tril_indices(count)] = -np.inf
    stretch = np.unravel_index(int(np.argmax(turned_m)), turned_m.shape)
    rows = [
        _row_move(length, (before, after, entry, leave), gap_m, lengths_m)
        for length in range(2, min(_LONGEST_ROW, count - 1) + 1)
    ]
    row_m, length, first, gap, is_turned = max(rows, default=(0.0, 0, 0, 0, False))
    if max(gain_m[at], turned_m[stretch], row_m) <= _GAIN_M:
        return None
    if row_m > max(gain_m[at], turned_m[stretch]):
        row, rest = order[first : first + length], order[:first] + order[first + length :]
        row = _reversed(row, half) if is_turned else row
        gap -= length if gap > first else 0
        return rest[:gap] + row + rest[gap:]
    if gain_m[at] >= turned_m[stretch]:
        place, gap, mode = (int(value) for value in at)
        rest = order[:place] + order[place + 1 :]
        gap -= gap > place
        return [*rest[:gap], (order[place][0], mode), *rest[gap:]]
    first, last = (int(value) for value in stretch)
    return order[:first] + _reversed(order[first : last + 1], half) + order[last + 1 :]


def _row_move(
    length: int, nodes: tuple[NDArray[np.intp], ...], gap_m: Array, lengths_m: Array
) -> tuple[float, int, int, int, bool]:
    """The best move of `length` items in a row: what it saves, the length, the first item, the gap that it is
    moved to, and whether it is turned round.
    """
    before, after, entry, leave = nodes
    rows = len(entry) - length + 1
    first, last = entry[:rows], leave[length - 1 :]
    saved_m = gap_m[:rows] + gap_m[length:] - lengths_m[before[:rows], after[length:]]
    ways_m = np.stack(
        [
            lengths_m[before[None, :], one[:, None]] + lengths_m[other[:, None], after[None, :]]
            for one, other in ((first, last), (last, first))
        ]
    )
    gain_m = saved_m[:, None] - (ways_m - gap_m)
    inside = np.arange(len(gap_m))[None, :] - np.arange(rows)[:, None]
    gain_m[:, (inside >= 0) & (inside <= length)] = -np.inf
    turned, row, gap = np.unravel_index(int(np.argmax(gain_m)), gain_m.shape)
    return float(gain_m[turned, row, gap]), length, int(row), int(gap), bool(turned)


def _reversed(row: list[tuple[int, int]], half: int) -> list[tuple[int, int]]:
    return [(item, (mode + half) % (2 * half)) for item, mode in reversed(row)]
