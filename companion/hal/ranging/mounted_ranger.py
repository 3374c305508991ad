"""A ranger on its mount: fixed ahead, or swept by a servo over up to 180°."""

import math
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import partial
from typing import Final, Protocol

from companion.config.actuators import PulseOutputSetting
from companion.config.sensors import RangerPart
from companion.core.readings import SonarReading
from companion.hal.background import Background
from companion.hal.pulses.lgpio_pulses import open_lgpio_pulses
from companion.hal.ranging.echo_pins import HCSR04, JSNSR04T, EchoPinRanger
from companion.hal.ranging.serial_ranger import (
    A02YYUW,
    TFMINI,
    SerialRanger,
    a02yyuw_range_m,
    tfmini_range_m,
)
from companion.hal.raspberry_pi import opening_pins
from companion.links.interfaces import Closable
from companion.links.port_url import open_line
from companion.sensors.servo_scan import ServoScan

_SERVO_STEP_S: Final = 0.06  # a micro servo turns 15° in 30 ms and settles
_SERVO_SETTLES_S: Final = 0.5  # from any position to the first bearing
_QUARTER_TURN_RAD: Final = 0.5 * math.pi  # of the servo's horn, at its longest and shortest pulse
_READINGS: Final = 256
_ECHO_CHIPS: Final = {"hcsr04": HCSR04, "jsnsr04t": JSNSR04T}


def sweep_bearings_rad(sweep_rad: float, step_rad: float) -> tuple[float, ...]:
    """One sweep from port to starboard and back, evenly spaced at step_rad or less.

    The ends occur once and all others twice, so the tuple can be repeated. A sweep of zero looks ahead.
    """
    if sweep_rad <= 0.0:
        return (0.0,)
    count = max(1, math.ceil(sweep_rad / step_rad - 1e-9))
    across = [sweep_rad * (index / count - 0.5) for index in range(count + 1)]
    return (*across, *across[-2:0:-1])


class Ranger(Closable, Protocol):
    """Measures ranges in the direction that it is turned to. period_s: between two of them, at least."""

    period_s: float

    def ping_m(self) -> float | None:
        """Range of the nearest echo, None without one in range.
        Raises HardwareError: the part does not respond.
        """

    def forget(self) -> None:
        """Drop what was measured before: it has been turned since."""


class MountedRanger:
    """Satisfies `companion.hal.interfaces.Sonar`: pings along a sweep.

    turn: called with the next bearing, rad from the bow, clockwise; None for a fixed ranger. range_m: least
    and greatest range. `step` is one ping; `start` runs it in a thread.
    """

    def __init__(
        self,
        ranger: Ranger,
        now: Callable[[], float],
        bearings_rad: Sequence[float] = (0.0,),
        turn: Callable[[float], None] | None = None,
        range_m: tuple[float, float] = (0.02, 4.0),
        release: Callable[[], None] | None = None,
    ) -> None:
        self._ranger = ranger
        self._now = now
        self._scan = ServoScan(bearings_rad)
        self._turn = turn
        self._release = release
        self._min_range_m, self._max_range_m = range_m
        self._period_s = ranger.period_s if turn is None else max(ranger.period_s, _SERVO_STEP_S)
        self._readings: deque[SonarReading] = deque(maxlen=_READINGS)
        self._background = Background(
            self.step, "sonar", first_wait_s=0.0 if turn is None else _SERVO_SETTLES_S
        )
        self._is_closed = False
        if turn is not None:
            turn(self._scan.bearing_rad)

    def start(self) -> None:
        """Begin to ping in a thread."""
        self._background.start()

    def step(self) -> float:
        """Ping once, turn to the next bearing, and return the seconds to the next ping.
        Raises HardwareError: the part does not respond.
        """
        bearing_rad = self._scan.bearing_rad
        if self._turn is not None:
            self._ranger.forget()
        range_m = self._ranger.ping_m()
        self._readings.append(
            SonarReading(self._now(), bearing_rad, range_m, self._min_range_m, self._max_range_m)
        )
        if self._turn is not None:
            self._turn(self._scan.turn())
        return self._period_s

    def read(self) -> Sequence[SonarReading]:
        readings: list[SonarReading] = []
        while self._readings:
            readings.append(self._readings.popleft())
        return readings

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        self._scan.set_sector(port_rad, starboard_rad)

    def close(self) -> None:
        if self._is_closed:
            return
        self._is_closed = True
        self._background.close()
        self._ranger.close()
        if self._release is not None:
            self._release()


def open_ranger(part: RangerPart, now: Callable[[], float], pin_factory: object = None) -> MountedRanger:
    """Open the ranger, and its servo if configured, and start pinging.
    Raises ConfigError: the port url is invalid; HardwareError: gpiozero is missing, there are no pins, or one
    is in use; LinkError: the port cannot be opened.
    """
    with ExitStack() as undo:
        ranger = _open_bare(part, now, pin_factory)
        undo.callback(ranger.close)
        if part.servo < 0:
            sonar = MountedRanger(ranger, now, range_m=part.range_m)
        else:
            signal = servo_signal(part.servo)
            servo = open_lgpio_pulses(signal)
            undo.callback(servo.close)

            def turn(bearing_rad: float) -> None:
                servo.write_us(signal.width_us(bearing_rad / _QUARTER_TURN_RAD))

            bearings_rad = sweep_bearings_rad(part.sweep_rad, part.step_rad)
            sonar = MountedRanger(ranger, now, bearings_rad, turn, part.range_m, servo.close)
        undo.pop_all()
    sonar.start()
    return sonar


def _open_bare(part: RangerPart, now: Callable[[], float], pin_factory: object) -> Ranger:
    max_range_m = part.range_m[1]
    match part.driver:
        case "a02yyuw":
            kind, decode = A02YYUW, a02yyuw_range_m
        case "tfmini":
            kind = TFMINI
            decode = partial(tfmini_range_m, min_strength=part.min_strength)
        case _:
            with opening_pins("sonar") as gpiozero, ExitStack() as undo:
                trigger = undo.enter_context(gpiozero.GPIODevice(part.trigger, pin_factory=pin_factory))
                echo = undo.enter_context(gpiozero.InputDevice(part.echo, pin_factory=pin_factory))
                chip = _ECHO_CHIPS[part.driver]
                ticks_to_s = echo.pin_factory.ticks_diff
                ranger = EchoPinRanger(trigger, echo, ticks_to_s, max_range_m, part.air_c, chip)
                undo.pop_all()
            return ranger
    return SerialRanger(open_line(part.port, kind.baud, now), kind, decode, max_range_m)


def servo_signal(pin: int) -> PulseOutputSetting:
    """The signal of a micro servo of 180°; its longest pulse turns it counter-clockwise, to port.

    gpiozero's own servo would turn in steps of 18°: it sets lgpio's pulses in percent of the period.
    """
    return PulseOutputSetting(
        output="software", pin=pin, min_us=500, trim_us=1500, max_us=2500, reversed=True
    )
