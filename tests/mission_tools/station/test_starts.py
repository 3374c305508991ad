"""A boat whose clock goes back has begun anew."""

import pytest

from companion.mavlink.dialect import dialect
from mission_tools.station.view import HANDLERS, View


def hear(view: View, boot_ms: int) -> None:
    message = dialect.MAVLink_system_time_message(0, boot_ms)
    HANDLERS[message.get_msgId()](view, message)


@pytest.mark.parametrize(
    ("clocks", "starts"),
    [
        ([0, 1000, 2000], 0),
        ([90_000, 89_600, 90_200], 0),  # two links that change the order
        ([90_000, 89_600, 89_200, 90_200], 1),
        ([90_000, 100, 1000], 1),
        ([90_000, 100, 1000, 0, 50], 2),
    ],
)
def test_a_clock_that_goes_back_counts(clocks: list[int], starts: int) -> None:
    view = View()
    for boot_ms in clocks:
        hear(view, boot_ms)
    assert view.starts == starts
