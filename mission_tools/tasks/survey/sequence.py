"""The order in which cells are sailed, and each cell's end to begin at.

An item may be sailed in several modes, each with an entry, an exit and a length in between: a generalised
travelling salesman problem. The order starts with the nearest neighbour and is improved by moving one item,
in any mode, and by reversing a stretch, the best move first, until none shortens it.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_GAIN_M = 1e-6


class Mode(NamedTuple):
    """One way to sail an item: the nodes where it begins and ends, and the length of the transits within."""

    entry: int
    exit: int
    inner_m: float


def best_sequence(
    items: Sequence[Sequence[Mode]], lengths_m: Array, start: int, end: int
) -> list[tuple[int, int]]:
    """(item, mode) in the order of sailing, from node `start` to node `end`.

    lengths_m: between nodes, symmetric. Each item has the same even number of modes; the second half are
    those of the first half, reversed.
    """
    entries, exits, inner_m = (
        np.array([[mode[field] for mode in modes] for modes in items]) for field in range(3)
    )
    entries, exits = entries.astype(np.intp), exits.astype(np.intp)
    half = entries.shape[1] // 2
    order = _nearest_first(entries, exits, lengths_m, start)
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
    if max(gain_m[at], turned_m[stretch]) <= _GAIN_M:
        return None
    if gain_m[at] >= turned_m[stretch]:
        place, gap, mode = (int(value) for value in at)
        rest = order[:place] + order[place + 1 :]
        gap -= gap > place
        return [*rest[:gap], (order[place][0], mode), *rest[gap:]]
    first, last = (int(value) for value in stretch)
    back = [(item, (mode + half) % (2 * half)) for item, mode in reversed(order[first : last + 1])]
    return order[:first] + back + order[last + 1 :]
