"""Shared test set-up: Hypothesis prints what it takes to replay a failure, and is reproducible in CI."""

import os
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "default", deadline=None, print_blob=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile("ci", parent=settings.get_profile("default"), derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "default")

# pytest puts tests/ first on the path, where tests/companion would stand in for the package of that name
sys.path.insert(0, str(Path(__file__).parents[1]))

from compiled.modules import stale  # noqa: E402


def pytest_configure() -> None:
    """Compiled modules stand before their sources: old ones would be tested instead."""
    if names := stale():
        more = f" and {len(names) - 1} more" if names[1:] else ""
        raise pytest.UsageError(f"{names[0]}{more} changed since make fast: run it again, or make slow")


def pytest_addoption(parser: pytest.Parser) -> None:
    """What `tests/protocol/conformance` is to be pointed at instead of our own boat."""
    parser.addoption(
        "--vehicle",
        metavar="URL",
        help="a vehicle to test, such as tcp:127.0.0.1:5760 (as pymavlink takes it)",
    )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests against the wall clock share their machine with whatever else runs there: each may be tried
    again, and says so in the report. Tests in simulated time get no second chance.
    """
    for item in items:
        if item.get_closest_marker("realtime") is not None:
            item.add_marker(pytest.mark.flaky(reruns=2))
