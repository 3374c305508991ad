"""Speed controllers that report over serial lines: KISS's frames come unasked, VESCs are asked."""

import math
import threading
from collections.abc import Callable, Iterator, Sequence

from companion.config.actuators import MotorsPart
from companion.core.readings import BatteryReading, EscReading
from companion.hal.interfaces import EscTelemetry
from companion.hal.port_sensor import PortSensor
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.sensors.esc_frames import (
    GET_VALUES,
    KissReader,
    VescReader,
    kiss_values,
    vesc_packet,
    vesc_values,
)

BAUD = 115200
_PAUSE_S = 0.01  # ends a frame of KISS, which takes 0.9 ms; the next comes 30 ms after it
_REST_S = 0.05  # between questions to a VESC: 20 answers a second

Readings = tuple[EscReading, ...]


class EscLine(PortSensor[Readings]):
    """Satisfies `EscTelemetry`: the latest reading of each controller on the line.

    side: of the one on the line. A VESC passes commands on to the right one, can_id. Its timeout does not
    count questions: they keep no motor running.
    """

    def __init__(self, port: Port, now: Callable[[], float], part: MotorsPart, side: int) -> None:
        is_vesc = part.protocol == "vesc"
        super().__init__(port, now, _REST_S if is_vesc else 0.0)
        self.reader = VescReader() if is_vesc else KissReader()
        self._parse = vesc_values if is_vesc else kiss_values
        self._pause_s = math.inf if is_vesc else _PAUSE_S
        self._erpm = math.tau / 60.0 / part.pole_pairs
        self._side = side
        self._can_id = part.can_id if side == 0 else -1
        self._questions = vesc_packet(GET_VALUES) if is_vesc else b""
        if is_vesc and self._can_id >= 0:
            self._questions += vesc_packet(GET_VALUES, can_id=self._can_id)
        self._readings: dict[int, EscReading] = {}
        self._heard_s = -math.inf
        self._lock = threading.Lock()

    def step(self) -> None:
        with self._lock:
            super().step()
        if self._questions:
            self.send(self._questions)

    def send(self, packet: bytes) -> bool:
        """Send a packet whole; False if the line is unplugged or busy."""
        with self._lock:
            return any(link.send(packet) for link in self._links)

    def _decode(self, chunk: bytes, time_s: float) -> Iterator[Readings]:
        if time_s - self._heard_s > self._pause_s:
            self._forget()
        self._heard_s = time_s
        for frame in self.reader.split(chunk):
            if (values := self._parse(frame)) is not None:
                side = 1 if 0 <= self._can_id == values.number else self._side
                before = self._readings.get(side)
                self._readings[side] = EscReading(
                    time_s,
                    side,
                    1 if before is None else before.count + 1,
                    self._erpm * values.erpm,
                    *values[1:-1],
                )
                yield tuple(self._readings.values())

    def _forget(self) -> None:
        self.reader.forget()


def open_esc_line(part: MotorsPart, side: int, now: Callable[[], float]) -> EscLine:
    """Open a controller's port. Raises as `open_line`."""
    return EscLine(open_line((part.left_port, part.right_port)[side], BAUD, now), now, part, side)


class EscBattery:
    """Satisfies `companion.hal.interfaces.Battery`: the voltage at the controllers, and what they draw."""

    def __init__(self, lines: Sequence[EscTelemetry], controllers: int) -> None:
        self._lines = lines
        self._controllers = controllers
        self._latest: BatteryReading | None = None

    def read(self) -> BatteryReading | None:
        """None until all have measured; as old as the oldest of them."""
        all_of = [one for line in self._lines for one in line.read() or ()]
        if len(all_of) < self._controllers:
            return None
        time_s = min(one.time_s for one in all_of)
        if self._latest is None or time_s > self._latest.time_s:
            voltage_v = sum(one.voltage_v for one in all_of) / len(all_of)
            self._latest = BatteryReading(time_s, voltage_v, sum(one.current_a for one in all_of))
        return self._latest

    def close(self) -> None:
        for line in self._lines:
            line.close()
