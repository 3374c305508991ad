"""An obstacle across the way of a sailing boat: seen, planned round within a second, and not touched."""

from pathlib import Path

import pytest

from benchmarks.planning.watched_run import sail_watched
from companion.core.geo import Point

pytestmark = pytest.mark.slow

RAFT = [(15.0, north, 1.0) for north in (-1.5, 0.0, 1.5)]


def test_a_raft_across_the_route_is_gone_round(tmp_path: Path) -> None:
    sailed = sail_watched(tmp_path, [Point(0.0, 0.0), Point(0.0, 28.0)], RAFT, seed=2)
    assert sailed.completed
    assert not sailed.touched
    assert sailed.uploads
    assert all(took_s <= 1.0 for _, took_s in sailed.uploads)
    assert sailed.missions[-1][-1].east_m == pytest.approx(28.0, abs=0.1)
    assert "HOLD" not in sailed.modes  # the boat goes on while it is given another mission
