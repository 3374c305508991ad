"""A Pi whose pins are mocks that record every change, and sensors that always answer."""

from collections.abc import Callable
from typing import Any, NamedTuple

from gpiozero.pins.mock import MockFactory, MockPWMPin

from companion.config.actuators import MotorsPart
from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon
from companion.core.readings import GnssFix, HeadingReading
from companion.hal.interfaces import Hardware
from companion.hal.motors.bridges import open_bridges

PINS = MotorsPart(driver="l298n")
LEGS = ((PINS.left_forward, PINS.left_backward), (PINS.right_forward, PINS.right_backward))
ENABLES = (PINS.left_enable, PINS.right_enable)
HERE = LatLon(50.0, -1.2)
AGE_S = 0.005  # of what a sensor hands over: always a little older than the tick that asks for it


class Change(NamedTuple):
    """One pin took one value."""

    pin: int
    value: float


class MockPi:
    """The pins of one boat, with a common record in the order of the changes."""

    def __init__(self) -> None:
        self.history: list[Change] = []
        history = self.history

        class RecordedPin(MockPWMPin):  # type: ignore[misc]
            def _change_state(self, value: float) -> bool:
                has_changed: bool = super()._change_state(value)
                if has_changed:
                    history.append(Change(int(self.info.name.removeprefix("GPIO")), float(value)))
                return has_changed

        self.factory = MockFactory(pin_class=RecordedPin)

    def level(self, pin: int) -> float:
        """What a pin is at now."""
        return next((change.value for change in reversed(self.history) if change.pin == pin), 0.0)

    @property
    def is_driving(self) -> bool:
        """Whether any motor gets current."""
        return any(self.level(enable) > 0.0 for enable in ENABLES)

    @property
    def is_off(self) -> bool:
        """Whether every pin is low."""
        return not any(self.level(pin) for pin in (*ENABLES, *LEGS[0], *LEGS[1]))

    def both_legs_were_on(self) -> bool:
        """Whether, at any time, both legs of one motor were on: the bridge would have shorted the motor."""
        level: dict[int, float] = {}
        for change in self.history:
            level[change.pin] = change.value
            if any(level.get(forward) and level.get(backward) for forward, backward in LEGS):
                return True
        return False

    def driven(self) -> set[int]:
        """The legs that have been on at some time."""
        return {pin for pin, value in self.history if value and any(pin in pair for pair in LEGS)}

    def hardware(
        self, config: BoatConfig, now: Callable[[], float], on_read: Callable[[], Any] = lambda: None
    ) -> Hardware:
        """A boat's hardware on these pins. on_read is called at every reading of the compass, once a tick."""
        motors = open_bridges(config.parts.motors, now, self.factory)
        return Hardware(motors, SteadyGnss(now), SteadyCompass(now, on_read))


class SteadyGnss:
    """Always has a fresh fix at the same place."""

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now

    def read(self) -> GnssFix:
        """A fix of this moment."""
        return GnssFix(self._now() - AGE_S, HERE, 3, 12, 0.9, 0.0, 0.0)

    def close(self) -> None:
        """Nothing to let go."""


class SteadyCompass:
    """Always points north."""

    def __init__(self, now: Callable[[], float], on_read: Callable[[], Any]) -> None:
        self._now = now
        self._on_read = on_read

    def read(self) -> HeadingReading:
        """A heading of this moment."""
        self._on_read()
        return HeadingReading(self._now() - AGE_S, 0.0, 0.0)

    def close(self) -> None:
        """Nothing to let go."""
