"""Hull sensors: the computer's thermometer, and a leak switch on a pin."""

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from companion.config.sensors import HullPart
from companion.core.readings import HullReading
from companion.hal.background import BackgroundSensor
from companion.hal.raspberry_pi import opening_pins

_PERIOD_S = 1.0


class DigitalInput(Protocol):
    """A digital input with a pull-up, as gpiozero's DigitalInputDevice: 1 is closed to ground."""

    @property
    def value(self) -> int: ...
    def close(self) -> None: ...


class HullSensor(BackgroundSensor[HullReading]):
    """Satisfies `companion.hal.interfaces.Hull`.

    thermometer: a file with millidegrees Celsius, as below /sys/class/thermal; None is reported if it cannot
    be read. opens_wet: the switch is closed while it is dry.
    """

    def __init__(
        self,
        thermometer: Path,
        switch: DigitalInput | None,
        now: Callable[[], float],
        *,
        opens_wet: bool = False,
    ) -> None:
        super().__init__(self.step, "hull sensor", now, lambda: switch.close() if switch else None)
        self._thermometer = thermometer
        self._switch = switch
        self._opens_wet = opens_wet

    def step(self) -> float:
        """Read once; returns the seconds to wait before the next reading."""
        is_wet = None if self._switch is None else bool(self._switch.value) is not self._opens_wet
        self._latest = HullReading(self._now(), is_wet, _celsius(self._thermometer))
        return _PERIOD_S


def _celsius(thermometer: Path) -> float | None:
    try:
        return int(thermometer.read_text(encoding="ascii")) / 1000.0
    except (OSError, ValueError):
        return None


def open_hull(part: HullPart, now: Callable[[], float]) -> HullSensor:
    """Open the thermometer, and the switch if configured, and start reading.
    Raises HardwareError: the pin is not available.
    """
    switch: DigitalInput | None = None
    if part.leak >= 0:
        with opening_pins("leak switch") as gpiozero:
            switch = gpiozero.DigitalInputDevice(part.leak, pull_up=True)
    return HullSensor(Path(part.thermometer), switch, now, opens_wet=part.leak_wet == "open").start()
