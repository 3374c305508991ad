from pathlib import Path

import pytest
from twins.lines import known

from companion.hal.hull import HullSensor


class FakeSwitch:
    """A pin."""

    def __init__(self) -> None:
        self.value = 0
        self.is_closed = False

    def close(self) -> None:
        """Let it go."""
        self.is_closed = True


def test_a_switch_that_water_opens_is_wet_when_its_wire_breaks(tmp_path: Path) -> None:
    switch = FakeSwitch()
    hull = HullSensor(tmp_path / "none", switch, lambda: 0.0, opens_wet=True)
    for closed, is_wet in ((1, False), (0, True)):  # a broken wire is an open switch
        switch.value = closed
        hull.step()
        reading = known(hull.read())
        assert reading.is_wet is is_wet


@pytest.mark.parametrize(
    ("content", "celsius"), [("48312\n", 48.312), ("-500", -0.5), ("", None), ("hot", None), (None, None)]
)
def test_the_computers_thermometer_is_read_in_millidegrees(
    tmp_path: Path, content: str | None, celsius: float | None
) -> None:
    thermometer = tmp_path / "temp"
    if content is not None:
        thermometer.write_text(content)
    hull = HullSensor(thermometer, None, lambda: 7.0)
    hull.step()
    reading = known(hull.read())
    assert (reading.time_s, reading.is_wet, reading.temperature_c) == (7.0, None, celsius)
