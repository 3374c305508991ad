"""Shared test set-up. Hypothesis tries the same examples in every run; with MAVBOAT_SEARCH=1 it looks for
new ones, and prints what it takes to replay a failure.
"""

import gc
import os
import signal
import sys
from collections.abc import Generator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "default",
    deadline=None,
    derandomize=True,
    max_examples=30,  # the same ones in every run; MAVBOAT_SEARCH tries others, and more
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.register_profile(
    "search", parent=settings.get_profile("default"), derandomize=False, max_examples=200
)
settings.register_profile("quick", parent=settings.get_profile("default"), max_examples=8)
settings.load_profile("search" if os.environ.get("MAVBOAT_SEARCH") else "default")

# Else each worker and each program that the tests start compiles all modules anew
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# A shell's background job ignores SIGINT, and so would the programs that the tests start and interrupt
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# pytest puts tests/ first on the path, where tests/companion would stand in for the package of that name
sys.path.insert(0, str(Path(__file__).parents[1]))

pytest_plugins = ["twins.fixtures"]


def pytest_addoption(parser: pytest.Parser) -> None:
    """What `tests/protocol/conformance` is to be pointed at instead of our own boat."""
    parser.addoption(
        "--vehicle",
        metavar="URL",
        help="a vehicle to test, such as tcp:127.0.0.1:5760 (as pymavlink takes it)",
    )


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """The garbage collector passes over what collection makes, thousands of tests that stay to the end."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()
