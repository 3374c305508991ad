"""The drawn archipelagos of the benchmark are water that routes can be asked of."""

import pytest

from benchmarks.planning.archipelago import archipelago, measured
from benchmarks.planning.route_oracle import shores_of


@pytest.mark.parametrize("vertices", [10, 1000])
def test_an_archipelago_has_as_many_vertices_as_asked_for(vertices: int) -> None:
    shores = shores_of(archipelago(vertices))
    assert sum(len(shore.corners) for shore in shores) == vertices


def test_what_is_measured_is_of_the_whole_map() -> None:
    found = measured(archipelago(1000))
    assert (found["vertices"], found["rings"]) == (1000, 53)
    assert 0.0 < found["median_ms"] <= found["cold_ms"]
