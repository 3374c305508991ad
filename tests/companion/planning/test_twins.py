"""The compiled kernels and their twins in Python give the same results, to the last bit."""

import random
from typing import Any

import pytest

from companion.core.geo import Point
from companion.planning import arcs, segments, tangent_search, tangents, view, visibility, water
from companion.planning.visibility import NoWay
from companion.planning.water import Shore, Water

pytestmark = pytest.mark.slow

CASES = 800
QUERIES = 10  # of each water


def is_compiled() -> bool:
    return visibility._tangents.__name__.endswith("._tangents")


def random_water(rng: random.Random) -> Water:
    """A basin with up to five islands, which may touch and overlap the shore and each other."""
    rings = [[Point(0.0, 0.0), Point(rng.uniform(20, 60), 0.0), Point(60.0, 60.0), Point(0.0, 60.0)]]
    for _ in range(rng.randint(1, 5)):
        north_m, east_m = rng.uniform(0, 60), rng.uniform(0, 60)
        rings.append(
            [
                Point(north_m + rng.choice((rng.uniform(-9, 9), 0.0, 5.0)), east_m + rng.uniform(-9, 9))
                for _ in range(rng.randint(1, 5))
            ]
        )
    shores = [Shore(ring, rng.choice((None, None, None, 2.5))) for ring in rings]
    return Water(shores[:1]).with_shores(shores[1:])


def results(seed: int) -> list[Any]:
    """All that a water answers."""
    rng = random.Random(seed)
    lake = random_water(rng)
    routes = lake.routes(rng.choice((0.0, 0.5, 1.0, 3.0)))
    answers: list[Any] = []
    for _ in range(QUERIES):
        a, b = (Point(rng.uniform(-5, 65), rng.uniform(-5, 65)) for _ in range(2))
        answers += [lake.is_water(a), lake.leg_distance_m(a, b), routes.is_clear(a, b)]
        try:
            answers.append(routes.route(a, b))
        except NoWay as no_way:
            answers += [no_way.reason, no_way.nearest]
    return answers


@pytest.mark.parametrize("part", range(2))
def test_kernel_and_twin_agree(part: int, monkeypatch: pytest.MonkeyPatch) -> None:
    if not is_compiled():
        pytest.skip("the kernels are not built: python setup.py build_ext --inplace")
    seeds = range(part * CASES // QUERIES // 2, (part + 1) * CASES // QUERIES // 2)
    compiled = [results(seed) for seed in seeds]
    monkeypatch.setattr(water, "_kernel", segments)
    monkeypatch.setattr(visibility, "_arcs", arcs)
    monkeypatch.setattr(visibility, "_view", view)
    monkeypatch.setattr(visibility, "_tangents", tangents)
    monkeypatch.setattr(visibility, "_tangent_search", tangent_search)
    for seed, kernels_own in zip(seeds, compiled, strict=True):
        assert results(seed) == kernels_own, f"seed {seed}"
