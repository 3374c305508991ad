"""Speed controllers that report over serial lines: KISS's frames come unasked, VESCs are asked."""

import threading
from collections.abc import Callable, Sequence

from companion.config.actuators import MotorsPart
from companion.core.readings import BatteryReading
from companion.hal.interfaces import EscTelemetry
from companion.hal.port_sensor import ParsedSensor
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.sensors.esc_frames import GET_VALUES, KissParser, Readings, VescParser, vesc_packet

BAUD = 115200
_REST_S = 0.05  # between questions to a VESC: 20 answers a second


class EscLine(ParsedSensor[Readings]):
    """Satisfies `EscTelemetry`: the latest reading of each controller on the line.

    side: of the one on the line. A VESC passes commands on to the right one, can_id. Its timeout does not
    count questions: they keep no motor running.
    """

    def __init__(self, port: Port, now: Callable[[], float], part: MotorsPart, side: int) -> None:
        is_vesc = part.protocol == "vesc"
        can_id = part.can_id if side == 0 else -1
        parser = (VescParser if is_vesc else KissParser)(side, part.pole_pairs, can_id)
        super().__init__(port, now, parser, _REST_S if is_vesc else 0.0)
        asked = sorted({-1, can_id}) if is_vesc else ()
        self._questions = b"".join(vesc_packet(GET_VALUES, can_id=one) for one in asked)
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
