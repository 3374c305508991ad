"""`boat-companion` on twins of every part: mock pins with an echo, and registers behind the I²C bus.

python -m benchmarks.full_boat_program FOLDER run --config boat.toml

What the twins cost counts as the boat's: the figures are upper bounds.
"""

import sys
import time
from pathlib import Path
from typing import Any

from gpiozero import Device
from gpiozero.pins.mock import MockFactory, MockPWMPin

from companion.app.cli import run_program
from companion.hal import raspberry_pi

TRIGGER, ECHO = 23, 24
_ECHO_S = 0.0176  # 3 m
_NOTHING_S = 0.038  # what the HC-SR04 holds its pin without an echo
_ECHO_EVERY = 10


class _Edges(MockPWMPin):  # type: ignore[misc]
    """The echo pin."""

    def edge(self, ticks_s: float, level: bool) -> None:
        self._last_change = ticks_s
        self._state = level
        if self._when_changed is not None:
            self._call_when_changed()


class _Trigger(MockPWMPin):  # type: ignore[misc]
    """Answers each pulse, on a time scale of its own: open water, with an echo now and then."""

    echo: _Edges
    clock_s = 0.0
    pulses = 0

    def _change_state(self, value: float) -> bool:
        has_fallen = bool(self._state) and not value
        has_changed: bool = super()._change_state(value)
        del self.states[:-1]  # the record would grow
        if has_fallen:
            self.clock_s += 1.0
            self.pulses += 1
            answer_s = _NOTHING_S if self.pulses % _ECHO_EVERY else _ECHO_S
            self.echo.edge(self.clock_s, True)
            self.echo.edge(self.clock_s + answer_s, False)
        return has_changed


def plug_in(folder: Path) -> None:
    """Put the twins below the drivers."""
    sys.path.append(str(Path(__file__).parents[1] / "tests"))
    import smbus2.smbus2  # noqa: PLC0415
    from twins.battery import Ads1115Twin, Ina226Twin  # noqa: PLC0415
    from twins.i2c import Bno055Twin, I2cDev  # noqa: PLC0415
    from twins.pulses import LgpioTwin, Pca9685Twin  # noqa: PLC0415

    compass = Bno055Twin()
    compass.yaw_rate_deg_s = 0.0  # the boat lies still
    bus = I2cDev(
        {
            0x28: compass,
            0x40: Ina226Twin(time.monotonic),
            0x41: _Unrecorded(Pca9685Twin()),
            0x48: Ads1115Twin(time.monotonic),
        }
    )
    raspberry_pi.DEVICE = folder / "i2c-1"
    raspberry_pi.DEVICE.touch()
    vars(smbus2.smbus2)["ioctl"] = bus.ioctl
    factory = MockFactory(pin_class=MockPWMPin)
    factory.ticks_diff = lambda later, earlier: later - earlier
    echo: Any = factory.pin(ECHO, pin_class=_Edges)
    trigger: Any = factory.pin(TRIGGER, pin_class=_Trigger)
    trigger.echo = echo
    Device.pin_factory = factory
    lgpio: Any = LgpioTwin({0: "pinctrl-bcm2711"})
    lgpio.tx_servo = lambda *_: 0  # the record would grow
    lgpio.tx_busy = lambda *_: 0
    sys.modules["lgpio"] = lgpio


class _Unrecorded:
    """A part whose record would grow for as long as it runs."""

    def __init__(self, part: Any) -> None:  # noqa: ANN401 — one of the twins
        self._part = part

    def get(self, register: int, length: int) -> bytes:
        data: bytes = self._part.get(register, length)
        return data

    def put(self, register: int, data: bytes) -> None:
        self._part.put(register, data)
        self._part.history.clear()


if __name__ == "__main__":
    plug_in(Path(sys.argv[1]))
    sys.exit(run_program(sys.argv[2:]))
