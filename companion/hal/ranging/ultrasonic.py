"""HC-SR04 ultrasonic ranger, fixed or swept by a servo over up to 180°.

A 10 µs trigger pulse makes the part send eight cycles of 40 kHz; it then holds the echo pin high for the
sound's travel time. Range = c t / 2, with the speed of sound in dry air c = 331.3 sqrt(1 + T / 273.15) ≈
331.3 + 0.606 T m/s, T in °C.
"""

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import Any, Protocol

from companion.config import parts
from companion.core.errors import HardwareError
from companion.hal.background import Background
from companion.hal.raspberry_pi import opening_pins
from companion.obstacles.perception.servo_scan import ServoScan
from companion.sensors.readings import SonarReading

MIN_RANGE_M = 0.02
PING_PERIOD_S = 0.06  # from the data sheet: avoids echoes of the last ping
_TRIGGER_PULSE_S = 10e-6
_ANSWER_S = 0.02  # the echo pin rises within this, or the part is missing
_SERVO_SETTLES_S = 0.5  # from any position to the first bearing
_READINGS = 256
_WATER_AIR_C = 15.0


def speed_of_sound_m_s(air_c: float) -> float:
    """In air at this temperature in °C."""
    return 331.3 + 0.606 * air_c


def sweep_bearings_rad(sweep_rad: float, step_rad: float) -> tuple[float, ...]:
    """One sweep from port to starboard and back, evenly spaced at step_rad or less.

    The ends occur once and all others twice, so the tuple can be repeated. A sweep of zero looks ahead.
    """
    if sweep_rad <= 0.0:
        return (0.0,)
    count = max(1, math.ceil(sweep_rad / step_rad - 1e-9))
    across = [sweep_rad * (index / count - 0.5) for index in range(count + 1)]
    return (*across, *across[-2:0:-1])


class Ranger(Protocol):
    """Measures one range."""

    def ping_m(self) -> float | None:
        """Range of the nearest echo, None without one in range.

        Raises:
            HardwareError: the part does not respond.
        """

    def close(self) -> None:
        """Release the pins."""


class PinDevice(Protocol):
    """A gpiozero device with one pin."""

    @property
    def pin(self) -> Any: ...  # noqa: ANN401 — gpiozero's Pin, which has no types
    def close(self) -> None: ...


class HcSr04:
    """One HC-SR04 on two gpiozero devices, timed by the edges' time stamps.

    trigger, echo: gpiozero GPIODevice; ticks_to_s: the pin factory's ticks_diff.
    """

    def __init__(
        self,
        trigger: PinDevice,
        echo: PinDevice,
        ticks_to_s: Callable[[float, float], float],
        max_range_m: float,
        air_c: float,
    ) -> None:
        self._trigger = trigger
        self._echo = echo
        self._ticks_to_s = ticks_to_s
        self._sound_m_s = speed_of_sound_m_s(air_c)
        self._max_range_m = max_range_m
        self._longest_s = 2.0 * max_range_m / self._sound_m_s
        self._edge_ticks: dict[bool, float] = {}  # rising: True
        self._has_fallen = threading.Event()
        trigger.pin.function = "output"
        trigger.pin.state = False
        echo.pin.edges = "both"
        echo.pin.bounce = None
        echo.pin.when_changed = self._on_edge

    def ping_m(self) -> float | None:
        """Range in metres, None without an echo in range; takes up to 20 ms plus the longest travel time.

        Raises:
            HardwareError: the echo pin is stuck high, or never rose: the part is missing.
        """
        self._has_fallen.clear()
        # Without an echo the part holds the pin for about 40 ms, some for 200: wait for its end.
        if self._echo.pin.state and not self._has_fallen.wait(0.25):
            raise HardwareError("sonar: the echo pin is stuck high")
        self._edge_ticks.clear()
        self._has_fallen.clear()
        self._trigger.pin.state = True
        time.sleep(_TRIGGER_PULSE_S)
        self._trigger.pin.state = False
        self._has_fallen.wait(_ANSWER_S + self._longest_s)
        rise, fall = self._edge_ticks.get(True), self._edge_ticks.get(False)
        if rise is None:
            raise HardwareError("sonar: no answer to the trigger; check power, trigger and echo wires")
        if fall is None:
            return None
        range_m = 0.5 * self._sound_m_s * self._ticks_to_s(fall, rise)
        return range_m if range_m <= self._max_range_m else None

    def close(self) -> None:
        """Release the pins. May be called twice."""
        self._trigger.close()
        self._echo.close()

    def _on_edge(self, ticks: float, level: int) -> None:
        if level:
            self._edge_ticks[True] = ticks
        elif True in self._edge_ticks:  # otherwise the late end of an abandoned ping
            self._edge_ticks[False] = ticks
            self._has_fallen.set()


class Ultrasonic:
    """Satisfies `companion.hal.interfaces.Sonar`: pings along a sweep.

    turn: called with the next bearing, rad from the bow, clockwise; None for a fixed ranger. `step` is one
    ping; `start` runs it in a thread.
    """

    def __init__(
        self,
        ranger: Ranger,
        now: Callable[[], float],
        bearings_rad: Sequence[float] = (0.0,),
        turn: Callable[[float], None] | None = None,
        max_range_m: float = 4.0,
        release: Callable[[], None] | None = None,
    ) -> None:
        self._ranger = ranger
        self._now = now
        self._scan = ServoScan(bearings_rad)
        self._turn = turn
        self._release = release
        self._max_range_m = max_range_m
        self._readings: deque[SonarReading] = deque(maxlen=_READINGS)
        self._background = Background(
            self.step, "sonar", first_wait_s=0.0 if turn is None else _SERVO_SETTLES_S
        )
        self._is_closed = False
        if turn is not None:
            turn(self._scan.bearing_rad)

    def start(self) -> None:
        """Start pinging."""
        self._background.start()

    def step(self) -> float:
        """Ping once, turn to the next bearing, and return the seconds to the next ping.

        Raises:
            HardwareError: the part does not respond.
        """
        bearing_rad = self._scan.bearing_rad
        time_s = self._now()
        range_m = self._ranger.ping_m()
        self._readings.append(SonarReading(time_s, bearing_rad, range_m, MIN_RANGE_M, self._max_range_m))
        if self._turn is not None:
            self._turn(self._scan.turn())
        return PING_PERIOD_S

    def read(self) -> Sequence[SonarReading]:
        """The pings since the last call, oldest first."""
        readings: list[SonarReading] = []
        while self._readings:
            readings.append(self._readings.popleft())
        return readings

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        """Sweep between these bearings."""
        self._scan.set_sector(port_rad, starboard_rad)

    def close(self) -> None:
        """Stop the thread and release the pins. May be called twice."""
        if self._is_closed:
            return
        self._is_closed = True
        self._background.close()
        self._ranger.close()
        if self._release is not None:
            self._release()


def open_ultrasonic(
    part: parts.SonarPart, now: Callable[[], float], pin_factory: object = None
) -> Ultrasonic:
    """Open the ranger, and its servo if configured, on the Pi's pins and start pinging.

    Raises:
        HardwareError: gpiozero is missing, there are no pins, or one is in use.
    """
    with opening_pins("sonar") as gpiozero, ExitStack() as undo:
        trigger = undo.enter_context(gpiozero.GPIODevice(part.trigger, pin_factory=pin_factory))
        echo = undo.enter_context(gpiozero.InputDevice(part.echo, pin_factory=pin_factory))
        ranger = HcSr04(trigger, echo, echo.pin_factory.ticks_diff, part.max_range_m, _WATER_AIR_C)
        if part.servo < 0:
            sonar = Ultrasonic(ranger, now, max_range_m=part.max_range_m)
        else:
            # A longer pulse turns a servo counter-clockwise seen from above: −90° is the longest.
            servo = gpiozero.AngularServo(
                part.servo,
                min_angle=90,
                max_angle=-90,
                min_pulse_width=0.0005,
                max_pulse_width=0.0025,
                pin_factory=pin_factory,
            )
            undo.enter_context(servo)

            def turn(bearing_rad: float) -> None:
                servo.angle = math.degrees(bearing_rad)

            bearings_rad = sweep_bearings_rad(part.sweep_rad, part.step_rad)
            sonar = Ultrasonic(ranger, now, bearings_rad, turn, part.max_range_m, servo.close)
        undo.pop_all()
    sonar.start()
    return sonar
