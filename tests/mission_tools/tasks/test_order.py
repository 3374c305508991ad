"""The order of a tour: exact against brute force, local search against exact."""

from collections.abc import Sequence
from itertools import pairwise, permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission_tools.tasks import tour as module
from mission_tools.tasks.tour import EXACT_STOPS, best_order


def matrix_of(seed: int, stops: int) -> module.Matrix:
    random = np.random.default_rng(seed)
    places = random.random((stops + 1, 2))
    lengths = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
    return np.asarray(lengths, dtype=np.float64)


def order_length_m(matrix: module.Matrix, order: Sequence[int], *, is_return: bool = False) -> float:
    """Of the route from place 0 in this order."""
    stops = [0, *order, *([0] if is_return else [])]
    return float(sum(matrix[a, b] for a, b in pairwise(stops)))


@given(st.integers(0, 10_000), st.integers(1, 6), st.booleans())
def test_the_order_of_few_stops_is_the_best_of_all(seed: int, stops: int, is_return: bool) -> None:
    lengths = matrix_of(seed, stops)
    found = best_order(lengths, is_return=is_return)
    best = min(
        order_length_m(lengths, order, is_return=is_return) for order in permutations(range(1, stops + 1))
    )
    assert sorted(found) == list(range(1, stops + 1))
    assert order_length_m(lengths, found, is_return=is_return) == pytest.approx(best, rel=1e-12)


@pytest.mark.parametrize("is_return", [False, True])
def test_local_search_comes_near_the_exact_order(monkeypatch: pytest.MonkeyPatch, is_return: bool) -> None:
    ratios = []
    for seed in range(20):
        lengths = matrix_of(seed, 10)
        exact = order_length_m(lengths, best_order(lengths, is_return=is_return), is_return=is_return)
        with monkeypatch.context() as patched:
            patched.setattr(module, "EXACT_STOPS", 0)
            local = best_order(lengths, is_return=is_return)
        ratios.append(order_length_m(lengths, local, is_return=is_return) / exact)
    assert min(ratios) >= 1.0 - 1e-12
    assert float(np.mean(ratios)) < 1.02
    assert max(ratios) < 1.12


def test_many_stops_along_a_ring_are_visited_round_it() -> None:
    stops = 3 * EXACT_STOPS
    angles = np.random.default_rng(4).permutation(stops + 1) * (2.0 * np.pi / (stops + 1))
    places = np.column_stack((np.cos(angles), np.sin(angles)))
    lengths = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
    side = 2.0 * np.sin(np.pi / (stops + 1))
    closed = best_order(lengths, is_return=True)
    assert order_length_m(lengths, closed, is_return=True) == pytest.approx((stops + 1) * side)
    assert order_length_m(lengths, best_order(lengths)) == pytest.approx(stops * side)
