"""The line to an autopilot: a port and a thread around the conversation, and the boat's parts behind it.

Closing one of the parts closes the line, and with it all the others.
"""

import threading
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from typing import Generic, TypeVar

from companion.config.boat_config import BoatConfig
from companion.core.drain import drain
from companion.core.readings import SonarReading
from companion.core.status_text import StatusText
from companion.hal.autopilot.link import AutopilotLink
from companion.hal.autopilot.readings import AutopilotReadings
from companion.hal.port_sensor import PortSensor
from companion.links.port_url import open_port, parse_port_url
from companion.links.retried import RetriedPort
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message

Reading = TypeVar("Reading")

_PATIENCE_S = 0.02  # a demand waits no longer, and a silent autopilot costs fifty looks a second
_MOST_REQUESTS = 64  # of stations, waiting for the line


class AutopilotLine(PortSensor[None]):
    """Satisfies `ArmedOutputs` and `MavlinkPart` of `companion.hal.interfaces`. port: may open later."""

    def __init__(self, port: RetriedPort, now: Callable[[], float], config: BoatConfig) -> None:
        super().__init__(port, now, patience_s=_PATIENCE_S)
        self.port = port
        self.link = AutopilotLink(config)
        self.is_closed = False
        self._requests: deque[tuple[Message, Address]] = deque(maxlen=_MOST_REQUESTS)
        self._encoder = Encoder(self.link.own)
        self._decoder = Decoder(datagram=False)

    def step(self) -> None:
        """Process received bytes, then send. Never waits."""
        super().step()
        self._send(self.link.tick(self._now()))
        for message, sender in drain(self._requests):
            if (addressed := self.link.addressed(message)) is not None:
                self._transmit(self._encoder.encode(addressed, sender))

    def close(self) -> None:
        """Motors off and disarmed first."""
        self._background.close()
        if not self.is_closed:
            self.is_closed = True
            self.allow(may_drive=False)
            self._send(self.link.tick(self._now()))
        self._release()

    @property
    def fault(self) -> str:
        return f"autopilot {self.link.outputs.fault}" if self.link.outputs.fault else ""

    def allow(self, *, may_drive: bool) -> None:
        self.link.outputs.may_drive = may_drive

    def take_texts(self) -> list[StatusText]:
        return drain(self.link.texts)

    @property
    def is_heard(self) -> bool:
        return self.link.is_heard(self._now())

    def send(self, message: Message, sender: Address) -> None:
        self._requests.append((message, sender))

    def take_messages(self) -> list[Message]:
        return drain(self.link.routed)

    def sensor(self, latest: Callable[[AutopilotReadings], Reading | None]) -> "AutopilotSensor[Reading]":
        return AutopilotSensor(self, latest)

    def sonar(self) -> "AutopilotSonar":
        return AutopilotSonar(self)

    def motors(self) -> "AutopilotMotors":
        return AutopilotMotors(self)

    def rudder(self) -> "AutopilotRudder":
        return AutopilotRudder(self)

    def _send(self, messages: Iterable[Message]) -> None:
        for message in messages:
            self._transmit(self._encoder.encode(message))

    def _transmit(self, data: bytes) -> None:
        for link in self._links:
            link.send(data)

    def _decode(self, chunk: bytes, time_s: float) -> Iterable[None]:
        for received in self._decoder.feed(chunk):
            self.link.handle(received.message, received.sender, time_s)
        return ()

    def _forget(self) -> None:
        self._decoder = Decoder(datagram=self._links[-1].is_datagram)


class _Part:
    def __init__(self, line: AutopilotLine) -> None:
        self._line = line
        self.close, self.take_texts = line.close, line.take_texts


class AutopilotSensor(_Part, Generic[Reading]):
    """Satisfies `Sensor` with one of `AutopilotReadings`."""

    def __init__(self, line: AutopilotLine, latest: Callable[[AutopilotReadings], Reading | None]) -> None:
        super().__init__(line)
        self._latest = latest

    def read(self) -> Reading | None:
        return self._latest(self._line.link.readings)


class AutopilotSonar(_Part):
    """Satisfies `Sonar`: rangers that are fixed."""

    def read(self) -> Sequence[SonarReading]:
        return drain(self._line.link.readings.pings)

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        """No effect."""


class AutopilotMotors(_Part):
    """Satisfies `Motors`."""

    def write(self, left: float, right: float) -> None:
        self._line.link.outputs.write(left, right)

    def stop(self) -> None:
        self._line.link.outputs.write(0.0, 0.0)


class AutopilotRudder(_Part):
    """Satisfies `Rudder`."""

    def write(self, share: float) -> None:
        self._line.link.outputs.write_rudder(share)


_lines: dict[str, AutopilotLine] = {}  # by url; the parts of one autopilot share its line
_opening = threading.Lock()


def open_autopilot(config: BoatConfig, now: Callable[[], float]) -> AutopilotLine:
    """The line, which is opened in a thread. Raises ConfigError: the url is invalid."""
    url = config.parts.autopilot_part.url
    name = f"Autopilot {parse_port_url(url)}"
    with _opening:
        if url not in _lines or _lines[url].is_closed:
            port = RetriedPort(name, lambda: open_port(url, now))
            _lines[url] = AutopilotLine(port.start(), now, config)
            _lines[url].start()
        return _lines[url]
