"""The line to an autopilot: a port and a thread around the conversation."""

from collections.abc import Callable, Iterable

from companion.config.boat_config import BoatConfig
from companion.core.errors import ConfigError
from companion.hal.autopilot.link import AutopilotLink
from companion.hal.autopilot.outputs import RoverOutputs
from companion.hal.port_sensor import PortSensor
from companion.links.retried import RetriedPort
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message

_PATIENCE_S = 0.02  # a demand waits no longer, and a silent autopilot costs fifty looks a second


class AutopilotLine(PortSensor[None]):
    """Messages in, readings and messages out. port: may open later."""

    def __init__(self, port: RetriedPort, now: Callable[[], float], config: BoatConfig) -> None:
        self.port = port
        super().__init__(port, now, patience_s=_PATIENCE_S)
        self.link = AutopilotLink(config)
        self._encoder = Encoder(self.link.own)
        self._decoder = Decoder(datagram=False)

    def step(self) -> None:
        """Process received bytes, then send. Never waits."""
        super().step()
        self._send(self.link.tick(self._now()))

    def close(self) -> None:
        """Motors off and disarmed first."""
        self._background.close()
        self._send(self.link.farewell())
        self._release()

    def _send(self, messages: Iterable[Message]) -> None:
        for message in messages:
            data = self._encoder.encode(message)
            for link in self._links:
                link.send(data)

    def _decode(self, chunk: bytes, time_s: float) -> Iterable[None]:
        for received in self._decoder.feed(chunk):
            self.link.handle(received.message, received.sender, time_s)
        return ()

    def _forget(self) -> None:
        self._decoder = Decoder(datagram=self._links[-1].is_datagram)

    @property
    def outputs(self) -> RoverOutputs:
        """Motors and rudder. Raises ConfigError: the boat has its own."""
        if self.link.outputs is None:
            raise ConfigError("parts.motors.driver: expected 'autopilot', as the rudder's")
        return self.link.outputs
