"""VESCs that are driven over their ports, by duty.

A VESC stops by itself when commands cease: after timeout_msec of its App Settings, 1000 ms as delivered,
whatever has become of the boat's program. Stop is a current of 0, which lets the motor coast; a duty of 0
would brake it. (bldc firmware, `commands.c`, `timeout.c`, `mc_interface_set_current`.)
"""

from collections.abc import Callable
from contextlib import ExitStack, suppress
from typing import Final

from companion.config.actuators import MotorsPart
from companion.core.errors import HardwareError, SilentOutputsError
from companion.hal.motors.esc import EscMotors
from companion.hal.motors.esc_line import EscLine, open_esc_line
from companion.sensors.esc_frames import SET_CURRENT, SET_DUTY, Readings, vesc_packet

STOPS_S: Final = 1.0  # APPCONF_TIMEOUT_MSEC
_FULL: Final = 100_000  # of SET_DUTY


class Vesc:
    """One VESC. can_id: of one that is reached over the line of another, −1 if it has a line. sign: ±1."""

    last_s = 0.0

    def __init__(self, line: EscLine, can_id: int, sign: int, now: Callable[[], float]) -> None:
        self.line, self.close = line, line.close
        self._can_id, self._sign = can_id, sign
        self._now, self._sent_s = now, now()

    def drive(self, share: float) -> None:
        """Drive at a share of full drive, −1..1. Raises SilentOutputsError: the line takes no commands."""
        duty = round(_FULL * self._sign * share)
        if not self.line.send(vesc_packet(SET_DUTY if duty else SET_CURRENT, duty, self._can_id)):
            are_off = self._now() - self._sent_s > STOPS_S
            raise SilentOutputsError("VESC: the line is unplugged or busy", are_off=are_off)
        self._sent_s = self._now()


class VescMotors(EscMotors):
    """Satisfies `companion.hal.interfaces.Motors` and `EscTelemetry`. Left first."""

    def __init__(self, sides: tuple[Vesc, ...], now: Callable[[], float]) -> None:
        super().__init__(sides, 0.0, now)
        self._lines = dict.fromkeys(side.line for side in sides)

    def read(self) -> Readings:
        return tuple([one for line in self._lines for one in line.read() or ()])

    def close(self) -> None:
        with suppress(HardwareError):  # a line that takes no command: its motors stop by themselves
            super().close()


def open_vescs(part: MotorsPart, now: Callable[[], float], *, has_right: bool) -> VescMotors:
    """Open the ports, and let the motors coast. Raises as `open_line`."""
    lines: list[EscLine] = []
    with ExitStack() as undo:
        for side in range(len(part.ports(has_right=has_right))):
            lines.append(open_esc_line(part, side, now))
            undo.callback(lines[-1].close)
            lines[-1].step()  # it takes commands from now on
        sides = [Vesc(lines[0], -1, -1 if part.left_reversed else 1, now)]
        if has_right:
            can_id = part.can_id if len(lines) == 1 else -1
            sides.append(Vesc(lines[-1], can_id, -1 if part.right_reversed else 1, now))
        motors = VescMotors(tuple(sides), now)
        for line in lines:
            line.start()
        undo.pop_all()
    return motors
