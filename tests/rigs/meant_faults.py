"""Faults that tests make in a tick on purpose are not logged. A test module asks for it by
`pytest_plugins = ("meant_faults",)` and `pytest.mark.usefixtures("meant_faults")`.
"""

import logging
from collections.abc import Iterator

import pytest


@pytest.fixture
def meant_faults() -> Iterator[None]:
    """Keep the safety net's logger silent."""
    logger = logging.getLogger("companion.autopilot.motor_output")
    logger.disabled = True
    yield
    logger.disabled = False
