"""L298N dual H-bridge: two brushed motors, three pins each.

IN1 and IN2 are on-off pins for the direction; PWM is on the enable pin. With enable low the bridge is open,
so one pin can stop a motor, the current freewheels between pulses, and a speed step does not touch the
direction pins. GPIO 12 and 13 are the default enable pins because the Pi pulls them down at reset: the motors
are off until the program owns the pins.

Truth table of the L298 data sheet (ST, figure 6): EN low = free; EN high with IN1 ≠ IN2 = drive; EN high with
IN1 = IN2 = short-circuit brake.
"""

import math
from collections.abc import Callable
from contextlib import ExitStack
from typing import Protocol

from companion.config import parts
from companion.core.errors import HardwareError
from companion.core.units import clamp
from companion.hal.raspberry_pi import opening_pins


class DigitalOutput(Protocol):
    """A digital output, as gpiozero's OutputDevice."""

    def on(self) -> None: ...
    def off(self) -> None: ...
    def close(self) -> None: ...


class Enable(Protocol):
    """A PWM output, as gpiozero's PWMOutputDevice; `value` is the duty cycle, 0..1."""

    value: float

    def off(self) -> None: ...
    def close(self) -> None: ...


class HalfBridgePair:
    """One motor: forward leg, backward leg, enable.

    A leg is switched on only after the opposite leg has been off for dead_time_s. Nothing sleeps: during the
    dead time both legs are off, and a later `drive` switches the new leg on.
    """

    def __init__(
        self,
        forward: DigitalOutput,
        backward: DigitalOutput,
        enable: Enable,
        dead_time_s: float,
        now: Callable[[], float],
    ) -> None:
        self._forward = forward
        self._backward = backward
        self._enable = enable
        self._dead_time_s = dead_time_s
        self._now = now
        self._direction: int | None = 0  # leg that is on: 1 forward, −1 backward, 0 neither, None unknown
        self._side = 0  # leg that was on last
        self._released_s = -math.inf

    def drive(self, share: float) -> None:
        """Drive at a share of full drive, −1..1."""
        direction = (share > 0.0) - (share < 0.0)
        if direction != self._direction:
            if self._direction != 0:
                self.release()
            if not direction or (
                direction != self._side and self._now() - self._released_s < self._dead_time_s
            ):
                return
            (self._backward if direction > 0 else self._forward).off()
            self._direction, self._side = None, direction  # unknown until the pin is set
            (self._forward if direction > 0 else self._backward).on()
            self._direction = direction
        if direction:
            self._enable.value = abs(share)

    def release(self) -> None:
        """Open the bridge: enable first, then both legs. All pins are tried even if one raises.

        Raises:
            HardwareError: a pin could not be switched.
        """
        if self._direction != 0:
            self._released_s = self._now()
            self._direction = None
        _try_all(self._enable.off, self._forward.off, self._backward.off)
        self._direction = 0

    def close(self) -> None:
        """Release the pins.

        Raises:
            HardwareError: a pin could not be released.
        """
        _try_all(self._enable.close, self._forward.close, self._backward.close)


class L298N:
    """Satisfies `companion.hal.interfaces.Motors` with two half-bridge pairs."""

    def __init__(self, left: HalfBridgePair, right: HalfBridgePair) -> None:
        self._left = left
        self._right = right
        self._is_closed = False
        self.stop()

    def write(self, left: float, right: float) -> None:
        """Drive both motors, −1..1, limited; a non-finite value stops both.

        Raises:
            HardwareError: closed, or a pin failed; both motors are then off.
        """
        if self._is_closed:
            raise HardwareError("L298N: written to after close")
        if not (math.isfinite(left) and math.isfinite(right)):
            self.stop()
            return
        try:
            self._left.drive(clamp(left, -1.0, 1.0))
            self._right.drive(clamp(right, -1.0, 1.0))
        except BaseException as error:
            try:
                self.stop()
            except HardwareError as stuck:
                raise stuck from error
            if isinstance(error, Exception):
                raise HardwareError(f"L298N: {error}") from error
            raise

    def stop(self) -> None:
        """Open both bridges now.

        Raises:
            HardwareError: a pin could not be switched off; all others were.
        """
        if not self._is_closed:
            _try_all(self._left.release, self._right.release)

    def close(self) -> None:
        """Stop, then release the pins. May be called twice.

        Raises:
            HardwareError: as `stop`; the pins are released anyway.
        """
        if self._is_closed:
            return
        try:
            _try_all(self.stop, self._left.close, self._right.close)
        finally:
            self._is_closed = True


def open_l298n(pins: parts.MotorsPart, now: Callable[[], float], pin_factory: object = None) -> L298N:
    """Open the bridge on the Pi's pins. `pin_factory` is gpiozero's; None: the default.

    The legs of a reversed motor are swapped here.

    Raises:
        HardwareError: gpiozero is missing, there are no pins, or one is in use.
    """
    with opening_pins("L298N") as gpiozero, ExitStack() as undo:

        def pair(forward: int, backward: int, enable: int, is_reversed: bool) -> HalfBridgePair:
            # Enable comes first: held low, it keeps the motor free while the legs are set up.
            pwm = gpiozero.PWMOutputDevice(enable, frequency=pins.pwm_hz, pin_factory=pin_factory)
            undo.enter_context(pwm)
            legs = (backward, forward) if is_reversed else (forward, backward)
            ahead, astern = (
                undo.enter_context(gpiozero.OutputDevice(leg, pin_factory=pin_factory)) for leg in legs
            )
            return HalfBridgePair(ahead, astern, pwm, pins.dead_time_s, now)

        bridge = L298N(
            pair(pins.left_forward, pins.left_backward, pins.left_enable, pins.left_reversed),
            pair(pins.right_forward, pins.right_backward, pins.right_enable, pins.right_reversed),
        )
        undo.pop_all()
    return bridge


def _try_all(*actions: Callable[[], None]) -> None:
    """Call every action, then raise the first error."""
    first: Exception | None = None
    for action in actions:
        try:
            action()
        except Exception as error:
            first = first or error
    if first is not None:
        raise first if isinstance(first, HardwareError) else HardwareError(f"L298N: {first}") from first
