"""Speed controllers (ESCs): one servo signal a motor.

An ESC starts only after it has seen the pulse of stop for a time, and stops, at the latest after a second or
two, when the pulses end; until then it goes on with the last one. So stop is a pulse, neutral, and is sent
before the pulses end. (Manuals of BLHeli_S, "Arming sequence", and KAVAN, "Throttle signal loss protection".)
"""

import math
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from typing import Protocol

from companion.config.actuators import PulseOutputSetting
from companion.core.errors import HardwareError
from companion.core.units import clamp
from companion.hal.interfaces import PulseOutput
from companion.links.interfaces import Closable

_LAST_PULSES = 3  # neutral ones, before the end


class Side(Closable, Protocol):
    """What drives one motor. last_s: for how long neutral is sent before the end."""

    @property
    def last_s(self) -> float: ...
    def drive(self, share: float, /) -> None: ...


class Esc:
    """One speed controller. A reversal passes neutral for dead_time_s."""

    def __init__(
        self, output: PulseOutput, setting: PulseOutputSetting, dead_time_s: float, now: Callable[[], float]
    ) -> None:
        self.close, self.last_s = output.close, _LAST_PULSES / setting.frequency_hz
        self._output = output
        self._setting = setting
        self._dead_time_s = dead_time_s
        self._now = now
        self._direction: int | None = 0  # 1 ahead, −1 astern, 0 neutral, None unknown
        self._side = 0  # driven last
        self._neutral_s = -math.inf

    def drive(self, share: float) -> None:
        """Drive at a share of full drive, −1..1."""
        direction = (share > 0.0) - (share < 0.0)
        if direction != self._direction:
            if self._direction != 0:
                self._neutral_s, self._direction = self._now(), None
            if direction and direction != self._side and self._now() - self._neutral_s < self._dead_time_s:
                share, direction = 0.0, 0
        self._output.write_us(self._setting.width_us(share))
        self._direction, self._side = direction, direction or self._side


class EscMotors:
    """Satisfies `companion.hal.interfaces.Motors` with one or two speed controllers.

    Neutral is sent from the start, and nothing else for arming_s; again so after a fault, when the ESCs may
    have lost their signal. Without a right one, the left is the boat's only motor.
    """

    def __init__(
        self,
        sides: tuple[Side, ...],
        arming_s: float,
        now: Callable[[], float],
        wait: Callable[[float], None] = time.sleep,
    ) -> None:
        self._sides = sides
        self._arming_s = arming_s
        self._now = now
        self._wait = wait
        self._armed_s = math.inf
        self._is_closed = False
        self.stop()
        self._armed_s = now() + arming_s

    def write(self, left: float, right: float) -> None:
        """Drive the motors, −1..1, limited; a non-finite value stops both, as does any while arming.
        Raises HardwareError: closed, or a signal failed; the others are then neutral.
        """
        if self._is_closed:
            raise HardwareError("ESC: written to after close")
        if not (math.isfinite(left) and math.isfinite(right)) or self._now() < self._armed_s:
            left = right = 0.0
        try:
            for side, share in zip(self._sides, (left, right), strict=False):
                side.drive(clamp(share, -1.0, 1.0))
        except BaseException as error:
            with suppress(HardwareError):
                self._neutral()
            if isinstance(error, HardwareError):
                self._armed_s = self._now() + self._arming_s
            raise

    def stop(self) -> None:
        """Neutral on every signal. Raises HardwareError: a signal failed; all others are neutral."""
        if not self._is_closed:
            self._neutral()

    def close(self) -> None:
        """Neutral for some pulses, then no more pulses. May be called twice.
        Raises HardwareError: a signal failed; all others have ended.
        """
        if self._is_closed:
            return
        self._is_closed = True
        with ExitStack() as rest:
            for side in reversed(self._sides):
                rest.callback(side.close)
            rest.callback(self._wait, max(side.last_s for side in self._sides))
            self._neutral()

    def _neutral(self) -> None:
        """Neutral on every signal, whatever one raises; after an error they arm anew."""
        try:
            with ExitStack() as rest:
                for side in reversed(self._sides):
                    rest.callback(side.drive, 0.0)
        except HardwareError:
            self._armed_s = self._now() + self._arming_s
            raise


def open_escs(
    settings: tuple[PulseOutputSetting, ...],
    dead_time_s: float,
    arming_s: float,
    now: Callable[[], float],
    open_output: Callable[[PulseOutputSetting], PulseOutput],
    wait: Callable[[float], None] = time.sleep,
) -> EscMotors:
    """Open the signals, one a motor, left first, and send neutral.
    Raises HardwareError: a signal cannot be opened; those already open are closed again.
    """
    outputs: list[PulseOutput] = []
    try:
        outputs.extend(open_output(setting) for setting in settings)
        sides = zip(outputs, settings, strict=True)
        escs = tuple(Esc(output, setting, dead_time_s, now) for output, setting in sides)
        return EscMotors(escs, arming_s, now, wait)
    except BaseException:
        for output in outputs:
            output.close()
        raise
