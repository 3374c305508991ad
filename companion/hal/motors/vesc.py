"""VESCs that are driven over their ports, by duty.

A VESC stops by itself when commands cease: after timeout_msec of its App Settings, 1000 ms as delivered,
whatever has become of the boat's program. Stop is a current of 0, which lets the motor coast; a duty of 0
would brake it. (bldc firmware, `commands.c`, `timeout.c`, `mc_interface_set_current`.)
"""

import math
from collections.abc import Callable
from contextlib import ExitStack, suppress
from typing import Final, NamedTuple

from companion.config.actuators import MotorsPart
from companion.core.errors import HardwareError, SilentOutputsError
from companion.core.readings import EscReading
from companion.core.units import clamp
from companion.hal.motors.esc_line import EscLine, open_esc_line
from companion.sensors.esc_frames import SET_CURRENT, SET_DUTY, vesc_packet

STOPS_S: Final = 1.0  # APPCONF_TIMEOUT_MSEC
_FULL: Final = 100_000  # of SET_DUTY


class Vesc(NamedTuple):
    """One VESC. can_id: of one that is reached over the line of another, −1 if it has a line. sign: ±1."""

    line: EscLine
    can_id: int
    sign: int


class VescMotors:
    """Satisfies `companion.hal.interfaces.Motors` and `EscTelemetry`. Left first."""

    def __init__(self, sides: tuple[Vesc, ...], now: Callable[[], float]) -> None:
        self._sides = sides
        self._now = now
        self._lines = tuple(dict.fromkeys(side.line for side in sides))
        self._is_closed = False
        self._sent_s = now()

    def write(self, left: float, right: float) -> None:
        """Drive the motors, −1..1, limited; a non-finite value stops both.
        Raises HardwareError: closed; SilentOutputsError: a line takes no commands; the other motor stops.
        """
        if self._is_closed:
            raise HardwareError("VESC: written to after close")
        if not (math.isfinite(left) and math.isfinite(right)):
            left = right = 0.0
        try:
            for side, share in zip(self._sides, (left, right), strict=False):
                self._send(side, share)
        except HardwareError:
            with suppress(HardwareError):
                self.stop()
            raise
        self._sent_s = self._now()

    def stop(self) -> None:
        """Let both coast. Raises SilentOutputsError: a line does not take it; the other motor stops."""
        with ExitStack() as rest:
            for side in self._sides:
                rest.callback(self._send, side, 0.0)

    def read(self) -> tuple[EscReading, ...]:
        return tuple([one for line in self._lines for one in line.read() or ()])

    def close(self) -> None:
        if not self._is_closed:
            self._is_closed = True
            with suppress(HardwareError):
                self.stop()
        for line in self._lines:
            line.close()

    def _send(self, side: Vesc, share: float) -> None:
        duty = round(_FULL * side.sign * clamp(share, -1.0, 1.0))
        command = SET_DUTY if duty else SET_CURRENT
        if not side.line.send(vesc_packet(command, duty, side.can_id)):
            are_off = self._now() - self._sent_s > STOPS_S
            raise SilentOutputsError("VESC: the line is unplugged or busy", are_off=are_off)


def open_vescs(part: MotorsPart, now: Callable[[], float], *, has_right: bool) -> VescMotors:
    """Open the ports, and let the motors coast. Raises as `open_line`."""
    sides: list[Vesc] = []
    lines = len(part.ports(has_right=has_right))
    turned = part.left_reversed, part.right_reversed
    with ExitStack() as undo:
        for side in range(1 + has_right):
            sign = -1 if turned[side] else 1
            if side >= lines:
                sides.append(Vesc(sides[0].line, part.can_id, sign))
                continue
            sides.append(Vesc(open_esc_line(part, side, now), -1, sign))
            undo.callback(sides[-1].line.close)
            sides[-1].line.step()  # it takes commands from now on
        motors = VescMotors(tuple(sides), now)
        motors.stop()
        for one in sides[:lines]:
            one.line.start()
        undo.pop_all()
    return motors
