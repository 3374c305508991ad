"""H-bridges for brushed motors: L298N, TB6612, BTS7960 (IBT-2) and DRV8833 or its kind.

One state machine drives them all; a row of PLANS says which pins a bridge has and where the PWM goes.

- L298N (ST data sheet, figure 6): EN low = open; EN high with IN1 ≠ IN2 = drive; EN high with IN1 = IN2 =
  brake. The PWM is on EN: the motor runs free between pulses, and one pin can stop it. TB6612FNG (Toshiba
  data sheet, control function) has the same inputs; between pulses it brakes.
- BTS7960 (Infineon data sheet Rev. 1.1, 4.4): INH low = open; INH high: IN switches the half-bridge up or
  down. The PWM is on the driven side's IN, the other side stays down: between pulses the motor brakes. Both
  INH of a motor are one pin here.
- DRV8833 (TI SLVSAR1E, 7.3.2), also DRV8871 and others with two inputs a motor: both low = open; one high =
  drive; both high = brake. The PWM is on the driven input, the other stays low: fast decay. No enable pin.

GPIO 12 and 13 are the default enable pins because the Pi pulls them down at reset: the motors are off until
the program owns the pins.
"""

import math
from collections.abc import Callable
from contextlib import ExitStack
from typing import NamedTuple, Protocol

from companion.config.actuators import MotorsPart
from companion.core.errors import HardwareError
from companion.core.units import clamp
from companion.hal.raspberry_pi import opening_pins


class PinPlan(NamedTuple):
    """name: for messages. legs_pulsed: the PWM is on the legs instead of on the enable pin."""

    name: str
    legs_pulsed: bool
    has_enable: bool = True


PLANS = {
    "l298n": PinPlan("L298N", legs_pulsed=False),
    "tb6612": PinPlan("TB6612", legs_pulsed=False),
    "bts7960": PinPlan("BTS7960", legs_pulsed=True),
    "drv8833": PinPlan("DRV8833", legs_pulsed=True, has_enable=False),
}
_PERIODS = 2  # lgpio changes a pulse train at the end of its period, one later if its thread is late


class PinOutput(Protocol):
    """An output, as gpiozero's OutputDevice or PWMOutputDevice; `value` is the level or duty cycle, 0..1."""

    value: float

    def off(self) -> None: ...
    def close(self) -> None: ...


class HalfBridgePair:
    """One motor: forward leg, backward leg, and the enable pin where there is one.

    A leg is switched on only after the opposite leg has been off for dead_time_s. Nothing sleeps: during the
    dead time both legs are off, and a later `drive` switches the new leg on.
    """

    def __init__(
        self,
        forward: PinOutput,
        backward: PinOutput,
        enable: PinOutput | None,
        dead_time_s: float,
        now: Callable[[], float],
        *,
        legs_pulsed: bool = False,
    ) -> None:
        self._forward = forward
        self._backward = backward
        self._enable = enable
        self._pins = [pin for pin in (enable, forward, backward) if pin is not None]  # in switch-off order
        self._dead_time_s = dead_time_s
        self._now = now
        self._legs_pulsed = legs_pulsed
        self._direction: int | None = 0  # leg that is on: 1 forward, −1 backward, 0 neither, None unknown
        self._side = 0  # leg that was on last
        self._released_s = -math.inf

    def drive(self, share: float) -> None:
        """Drive at a share of full drive, −1..1."""
        direction = (share > 0.0) - (share < 0.0)
        leg, opposite = (self._forward, self._backward) if direction > 0 else (self._backward, self._forward)
        steady, pulsed = (self._enable, leg) if self._legs_pulsed else (leg, self._enable)
        if direction != self._direction:
            if self._direction != 0:
                self.release()
            if not direction or (
                direction != self._side and self._now() - self._released_s < self._dead_time_s
            ):
                return
            opposite.off()
            self._direction, self._side = None, direction  # unknown until the pin is set
            if steady is not None:
                steady.value = 1.0
            self._direction = direction
        if direction and pulsed is not None:
            pulsed.value = abs(share)

    def release(self) -> None:
        """Open the bridge: enable first, then both legs. All pins are tried even if one raises.
        Raises HardwareError: a pin could not be switched.
        """
        if self._direction != 0:
            self._released_s = self._now()
            self._direction = None
        _try_all(*(pin.off for pin in self._pins))
        self._direction = 0

    def close(self) -> None:
        """Release the pins. Raises HardwareError: a pin could not be released."""
        _try_all(*(pin.close for pin in self._pins))


class BridgeMotors:
    """Satisfies `companion.hal.interfaces.Motors` with one or two motors.

    Without a right one, the left is the boat's only motor, and the right command is ignored.
    """

    def __init__(self, name: str, left: HalfBridgePair, right: HalfBridgePair | None) -> None:
        self._name = name
        self._left = left
        self._right = right
        self._sides = [side for side in (left, right) if side is not None]
        self._is_closed = False
        self.stop()

    def write(self, left: float, right: float) -> None:
        """Drive the motors, −1..1, limited; a non-finite value stops both.
        Raises HardwareError: closed, or a pin failed; both motors are then off.
        """
        if self._is_closed:
            raise HardwareError(f"{self._name}: written to after close")
        if not (math.isfinite(left) and math.isfinite(right)):
            self.stop()
            return
        try:
            self._left.drive(clamp(left, -1.0, 1.0))
            if self._right is not None:
                self._right.drive(clamp(right, -1.0, 1.0))
        except BaseException as error:
            try:
                self.stop()
            except HardwareError as stuck:
                raise stuck from error
            if isinstance(error, Exception):
                raise HardwareError(f"{self._name}: {error}") from error
            raise

    def stop(self) -> None:
        """Open the bridges now. Raises HardwareError: a pin could not be switched off; all others were."""
        if not self._is_closed:
            self._all(*(side.release for side in self._sides))

    def close(self) -> None:
        """Stop, then release the pins. May be called twice.
        Raises HardwareError: as `stop`; the pins are released anyway.
        """
        if self._is_closed:
            return
        try:
            self._all(self.stop, *(side.close for side in self._sides))
        finally:
            self._is_closed = True

    def _all(self, *actions: Callable[[], None]) -> None:
        try:
            _try_all(*actions)
        except HardwareError:
            raise
        except Exception as error:
            raise HardwareError(f"{self._name}: {error}") from error


def open_bridges(
    part: MotorsPart,
    now: Callable[[], float],
    pin_factory: object = None,
    *,
    has_right: bool = True,
) -> BridgeMotors:
    """Open the bridges on the Pi's pins. `pin_factory` is gpiozero's; None: the default.

    The legs of a reversed motor are swapped here.
    Raises HardwareError: gpiozero is missing, there are no pins, or one is in use.
    """
    plan = PLANS[part.driver]
    dead_time_s = max(part.dead_time_s, _PERIODS / part.pwm_hz) if plan.legs_pulsed else part.dead_time_s
    with opening_pins(plan.name) as gpiozero, ExitStack() as undo:

        def pin(number: int, *, is_pulsed: bool) -> PinOutput:
            if is_pulsed:
                device = gpiozero.PWMOutputDevice(number, frequency=part.pwm_hz, pin_factory=pin_factory)
            else:
                device = gpiozero.OutputDevice(number, pin_factory=pin_factory)
            output: PinOutput = undo.enter_context(device)
            return output

        def pair(forward: int, backward: int, enable: int, is_reversed: bool) -> HalfBridgePair:
            # Enable comes first: held low, it keeps the motor free while the legs are set up.
            enabling = pin(enable, is_pulsed=not plan.legs_pulsed) if plan.has_enable else None
            legs = (backward, forward) if is_reversed else (forward, backward)
            ahead, astern = (pin(leg, is_pulsed=plan.legs_pulsed) for leg in legs)
            return HalfBridgePair(ahead, astern, enabling, dead_time_s, now, legs_pulsed=plan.legs_pulsed)

        left = pair(part.left_forward, part.left_backward, part.left_enable, part.left_reversed)
        right = None
        if has_right:
            right = pair(part.right_forward, part.right_backward, part.right_enable, part.right_reversed)
        motors = BridgeMotors(plan.name, left, right)
        undo.pop_all()
    return motors


def _try_all(*actions: Callable[[], None]) -> None:
    """Call every action in turn, whatever one raises, then raise the last error."""
    with ExitStack() as rest:
        for action in reversed(actions):
            rest.callback(action)
