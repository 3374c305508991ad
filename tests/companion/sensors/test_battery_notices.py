"""What the operator is told of the battery monitor: a wrong number of cells, silence and its end."""

import pytest

from companion.core.status_text import Severity
from companion.sensors.fuel_gauge import cells_fault
from companion.sensors.silence import SilenceMonitor


@pytest.mark.parametrize(
    ("voltage_v", "cells", "text"),
    [
        (11.1, 3, ""),
        (9.61, 3, ""),
        (12.74, 3, ""),
        (9.59, 3, "Battery: 9.6 V does not fit 3 cells"),
        (12.76, 3, "Battery: 12.8 V does not fit 3 cells"),
        (14.8, 3, "Battery: 14.8 V does not fit 3 cells, but 4"),
        (11.1, 4, "Battery: 11.1 V does not fit 4 cells, but 3"),
        (24.8, 4, "Battery: 24.8 V does not fit 4 cells, but 7"),
        (0.0, 3, "Battery: 0.0 V does not fit 3 cells"),
    ],
)
def test_a_resting_pack_says_whether_its_cells_are_configured_rightly(
    voltage_v: float, cells: int, text: str
) -> None:
    assert cells_fault(voltage_v, cells) == text


def test_a_part_that_never_measured_is_silent_from_the_timeout_on() -> None:
    monitor = SilenceMonitor("Probe")
    assert monitor.update(3.0, 100.0, is_heard=False) is None
    assert monitor.update(3.0, 103.0, is_heard=False) is None
    assert monitor.update(3.0, 103.1, is_heard=False) == (Severity.WARNING, "Probe is silent")
    assert monitor.update(3.0, 200.0, is_heard=False) is None
    assert monitor.update(3.0, 200.1, is_heard=True) == (Severity.NOTICE, "Probe measures again")
    assert monitor.update(3.0, 203.0, is_heard=True) is None
    assert monitor.update(3.0, 203.1, is_heard=False) == (Severity.WARNING, "Probe is silent")


class Late:
    """A part that is missing at first."""

    is_open = False


def test_a_missing_part_is_not_silent_until_it_has_been_opened() -> None:
    part = Late()
    monitor = SilenceMonitor("Probe", part)
    assert [monitor.update(3.0, 0.1 * tick, is_heard=False) for tick in range(100)] == [None] * 100
    part.is_open = True
    assert [monitor.update(3.0, 10.0 + 0.1 * tick, is_heard=False) for tick in range(31)] == [None] * 31
    assert monitor.update(3.0, 13.2, is_heard=False) == (Severity.WARNING, "Probe is silent")
