"""Boats that write logs, closed when the test is over: a plugin that test modules ask for."""

from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest
from log_rig import LogRig, OpenRig


@pytest.fixture
def open_rig() -> Iterator[OpenRig]:
    """Makes rigs as LogRig does."""
    with ExitStack() as ending:

        def make(*arguments: Any, **options: Any) -> LogRig:  # noqa: ANN401
            rig = LogRig(*arguments, **options)
            ending.callback(rig.boat.close)
            return rig

        yield make
