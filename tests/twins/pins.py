"""Mock pins of a Pi that record every change in one list, and the rules of an H-bridge over it."""

import math
from typing import Any, NamedTuple

from gpiozero.pins.mock import MockFactory, MockPWMPin

from companion.config.actuators import MotorsPart
from companion.hal.motors.bridges import PLANS, BridgeMotors, open_bridges
from twins.lines import HandClock


class Change(NamedTuple):
    """One pin took one value."""

    time_s: float
    pin: int
    value: float


class Motor(NamedTuple):
    """The pins of one motor."""

    forward: int
    backward: int
    enable: int | None


L298N = MotorsPart(driver="l298n")
BRIDGES = [
    L298N,
    MotorsPart(driver="tb6612"),
    MotorsPart(driver="bts7960"),
    MotorsPart(driver="drv8833", left_forward=17, left_backward=27),
]


def motors_of(part: MotorsPart) -> list[Motor]:
    """The pins that the driver uses."""
    left = Motor(part.left_forward, part.left_backward, part.left_enable)
    right = Motor(part.right_forward, part.right_backward, part.right_enable)
    return [
        motor if PLANS[part.driver].has_enable else motor._replace(enable=None) for motor in (left, right)
    ]


class PinBoard:
    """A Pi with mock pins and a common record."""

    def __init__(self, part: MotorsPart = L298N, clock: HandClock | None = None) -> None:
        self.part = part
        self.clock = clock or HandClock()
        self.history: list[Change] = []
        board = self

        class RecordedPin(MockPWMPin):  # type: ignore[misc]
            def _change_state(self, value: float) -> bool:
                has_changed: bool = super()._change_state(value)
                if has_changed:
                    board.history.append(Change(board.clock(), int(self.info.name[4:]), float(value)))
                return has_changed

        self.factory = MockFactory(pin_class=RecordedPin)

    def open(self, part: MotorsPart | None = None, *, has_right: bool = True) -> BridgeMotors:
        self.part = part or self.part
        bridge = open_bridges(self.part, self.clock, self.factory, has_right=has_right)
        self.history.clear()
        return bridge

    def pin(self, number: int) -> Any:  # noqa: ANN401 — gpiozero has no types
        return self.factory.pin(number)

    def levels(self) -> dict[int, float]:
        return {
            pin: float(self.pin(pin).state)
            for motor in motors_of(self.part)
            for pin in motor
            if pin is not None
        }

    @property
    def is_off(self) -> bool:
        return not any(self.levels().values())

    def drive(self, motor: Motor) -> float:
        """Share of full drive that the bridge gives the motor, by its truth table; positive is ahead."""
        levels = self.levels()
        if motor.enable is not None and not levels[motor.enable]:
            return 0.0
        sign = bool(levels[motor.forward]) - bool(levels[motor.backward])
        duty = levels[motor.enable] if motor.enable is not None else 1.0
        return sign * duty * (levels[motor.forward] or levels[motor.backward])

    def drain(self) -> list[tuple[int, float]]:
        changes = [(change.pin, change.value) for change in self.history]
        self.history.clear()
        return changes


def assert_is_safe(history: list[Change], part: MotorsPart, dead_time_s: float) -> None:
    """Replay the record: whatever the commands were, these hold at every single change of a pin."""
    legs_pulsed = PLANS[part.driver].legs_pulsed
    for motor in motors_of(part):
        level = dict.fromkeys(motor, 0.0)
        fell_s = dict.fromkeys(motor, -math.inf)
        for change in history:
            if change.pin not in level:
                continue
            was, level[change.pin] = level[change.pin], change.value
            assert 0.0 <= change.value <= 1.0
            if change.pin == motor.enable:
                continue
            if not legs_pulsed:
                assert level[motor.enable] == 0.0, "a leg moved while its motor was enabled"
            opposite = motor.backward if change.pin == motor.forward else motor.forward
            if change.value:
                assert level[opposite] == 0.0, "both legs on"
                assert change.time_s - fell_s[opposite] >= dead_time_s, "no dead time"
            elif was:
                fell_s[change.pin] = change.time_s
