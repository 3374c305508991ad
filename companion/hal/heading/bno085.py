"""BNO085 or BNO086 compass on a UART (PS1 high, PS0 low: UART-SHTP at 3 Mbit/s).

Not on I²C: the part stretches the clock, which the Pi's controller does not support; bytes are then shifted
(raspberrypi/linux issue 4884). Its simple UART mode (RVC) has no magnetic north, as it does not use the
magnetometer.
"""

import time
from collections.abc import Callable, Iterable
from typing import Final

from companion.config.sensors import CompassPart
from companion.core.readings import HeadingReading
from companion.core.status_text import Severity
from companion.hal.heading.orientation import board_to_body, heading_reading
from companion.hal.port_sensor import PortSensor
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.sensors.sh2 import Sh2Session
from companion.sensors.silence import SilenceMonitor

BAUD: Final = 3_000_000
# The part needs 100 µs from one byte to the next (data sheet 1000-3927, 1.2.3.1)
BYTE_S: Final = 0.0002
_REST_S: Final = 0.01
_SILENT_S: Final = 2.0


class Bno085Compass(PortSensor[HeadingReading]):
    """Satisfies `companion.hal.interfaces.Compass`.

    Its north is magnetic. Headings are used once the part has called its own reliable, since its last reset.
    """

    def __init__(
        self,
        port: Port,
        part: CompassPart,
        now: Callable[[], float],
        pause: Callable[[float], None] = time.sleep,
    ) -> None:
        """pause: between two bytes."""
        super().__init__(port, now, _REST_S)
        self._axes = board_to_body(part.mounting)
        self._correction_rad = part.correction_rad
        self._pause = pause
        self._session = Sh2Session(now())
        self._knows_north = False
        self._resets = 0
        self._heard_s = now()
        self._silence = SilenceMonitor("Compass: BNO085", again="answers again")

    def step(self) -> None:
        super().step()
        now_s = self._now()
        self._session.tick(now_s)
        is_heard = now_s - self._heard_s <= _SILENT_S
        if text := self._silence.update(0.0, now_s, is_heard=is_heard):
            self.notify(*text)
        for frame in self._session.take_outbox():
            for link in self._links:
                for at in range(len(frame)):
                    link.send(frame[at : at + 1])
                    self._pause(BYTE_S)

    def _forget(self) -> None:
        self._session = Sh2Session(self._now())
        self._knows_north, self._resets = False, 0

    def _decode(self, chunk: bytes, time_s: float) -> Iterable[HeadingReading]:
        samples = self._session.feed(chunk, time_s)
        if self._session.resets != self._resets:
            if self._resets:
                self.notify(Severity.WARNING, "Compass: BNO085 was reset: it must find north again")
            self._resets, self._knows_north = self._session.resets, False
        if samples:
            self._heard_s = time_s
        for sample in samples:
            self._knows_north = self._knows_north or sample.status > 0
            if self._knows_north:
                yield heading_reading(
                    sample.quaternion, sample.rate, self._axes, self._correction_rad, time_s
                )


def open_bno085(part: CompassPart, now: Callable[[], float]) -> Bno085Compass:
    """Open the part on its serial line and start reading.
    Raises ConfigError: the port url is invalid; LinkError: the port cannot be opened.
    """
    return Bno085Compass(open_line(part.port, BAUD, now), part, now).start()
