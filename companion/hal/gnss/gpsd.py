"""GNSS receiver behind gpsd."""

from collections.abc import Callable, Iterable
from typing import Final

from companion.config.sensors import GnssPart
from companion.core.errors import ConfigError
from companion.core.readings import GnssFix
from companion.hal.port_sensor import PortSensor
from companion.links.interfaces import Port
from companion.links.port_url import open_port, parse_port_url
from companion.sensors.gpsd import WATCH, GpsdReader
from companion.sensors.silence import SilenceMonitor, fresh

_DEFAULT: Final = "127.0.0.1:2947"


class GpsdGnss(PortSensor[GnssFix]):
    """Satisfies `companion.hal.interfaces.Gnss`. Connects again when gpsd is restarted."""

    def __init__(self, port: Port, now: Callable[[], float], latency_s: float, timeout_s: float) -> None:
        """latency_s: shortest time from measurement to arrival. timeout_s: of the receiver's silence."""
        super().__init__(port, now)
        self.reader = GpsdReader(latency_s)
        self._must_ask = False
        self._silence, self._timeout_s = SilenceMonitor("GNSS: gpsd"), timeout_s

    def step(self) -> None:
        super().step()
        if self._must_ask and self._links:
            self._must_ask = not self._links[-1].send(WATCH)
        now_s = self._now()
        is_heard = fresh(self._latest, self._timeout_s, now_s) is not None
        if (text := self._silence.update(self._timeout_s, now_s, is_heard=is_heard)) is not None:
            self.notify(*text)

    def _decode(self, chunk: bytes, time_s: float) -> Iterable[GnssFix]:
        return self.reader.feed(chunk, time_s)

    def _forget(self) -> None:
        self.reader.forget()
        self._must_ask = True


def open_gpsd_gnss(part: GnssPart, now: Callable[[], float]) -> GpsdGnss:
    """Connect in the background.
    Raises ConfigError: the port is not HOST:PORT; LinkError: the host is unknown.
    """
    place = _DEFAULT if part.port == GnssPart().port else part.port
    url = place if place.startswith("tcp") else f"tcp:{place}"
    if place.startswith("/") or parse_port_url(url).kind != "tcpout":
        raise ConfigError(f"parts.gnss.port = {part.port!r}: expected HOST:PORT of gpsd, such as {_DEFAULT}")
    return GpsdGnss(open_port(url, now), now, part.latency_s, part.timeout_s).start()
