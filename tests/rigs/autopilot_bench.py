"""The boat's end of an autopilot's line beside a twin of Rover, in steps of a tick."""

from twins.lines import HandClock, known
from twins.rover import RUDDER, SET_UP, Rover

from companion.config.boat_config import BoatConfig, decode_config
from companion.core.errors import SilentOutputsError
from companion.hal.autopilot.line import AutopilotLine
from companion.hal.autopilot.link import AutopilotLink
from companion.hal.autopilot.outputs import RoverOutputs
from companion.hal.autopilot.readings import AutopilotReadings
from companion.links.memory import MemoryLink, MemoryPort, memory_pair
from companion.links.retried import RetriedPort
from companion.mavlink.codec import Decoder, Encoder

TICK_S = 0.02


def config(layout: str = "differential", /, **autopilot: object) -> BoatConfig:
    """A boat with everything behind the autopilot."""
    part = {"url": "tcpout:127.0.0.1:5760", **autopilot}
    tables = {"parts": {"autopilot": part}, "drive": {"layout": layout}}
    return decode_config({"links": ["udpin:127.0.0.1:0"], **tables}, "test")


class Bench:
    """hears, is_heard: whether the line carries bytes from the autopilot, and to it."""

    def __init__(self, layout: str = "differential", **autopilot: object) -> None:
        self.rover = Rover(dict(RUDDER if layout == "rudder" else SET_UP))
        self.link = AutopilotLink(config(layout, **autopilot))
        self.now_s = 100.0
        self.hears = self.is_heard = True
        self.demand = (0.0, 0.0)
        self.errors: list[str] = []
        self.texts: list[str] = []
        self._decoder, self._encoder = Decoder(datagram=False), Encoder(self.link.own)

    @property
    def outputs(self) -> RoverOutputs:
        return self.link.outputs

    @property
    def readings(self) -> AutopilotReadings:
        return self.link.readings

    def feed(self, data: bytes) -> None:
        """Bytes from the line."""
        for one in self._decoder.feed(data):
            self.link.handle(one.message, one.sender, self.now_s)

    def run(self, seconds: float) -> None:
        """Both sides go on."""
        for _ in range(round(seconds / TICK_S)):
            self.now_s += TICK_S
            sent = self.rover.step(TICK_S)
            if self.hears:
                self.feed(sent)
            try:
                self.outputs.write(*self.demand)
            except SilentOutputsError as error:
                self.errors.append(str(error))
            for message in self.link.tick(self.now_s):
                data = self._encoder.encode(message)
                if self.is_heard:
                    self.rover.receive(data)
            self.texts += [one.text for one in self.link.texts]
            self.link.texts.clear()

    def ready(self) -> "Bench":
        """Its parameters are read, and it may be armed."""
        self.run(25.0)
        assert not self.outputs.fault, self.outputs.fault
        return self

    def driving(self, left: float = 0.5, right: float = 0.5) -> "Bench":
        """The boat is armed and drives."""
        self.ready()
        self.outputs.may_drive = True
        self.demand = left, right
        self.run(2.0)
        assert not self.outputs.fault, self.outputs.fault
        return self


class Plug:
    """An autopilot's line without its thread, which can be unplugged."""

    def __init__(self, clock: HandClock, **autopilot: object) -> None:
        self.clock, self.rover, self.port = clock, Rover(), MemoryPort()
        retried = RetriedPort("Autopilot", lambda: self.port)
        retried.attempt()
        self.line = AutopilotLine(retried, clock, config(**autopilot))
        self.far: MemoryLink | None = None

    def plug_in(self) -> None:
        near, self.far = memory_pair(is_datagram=False)
        self.port.offer(near)

    def unplug(self) -> None:
        known(self.far).close()
        self.far = None

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / TICK_S)):
            self.clock.advance(TICK_S)
            sent = self.rover.step(TICK_S)
            if self.far is not None:
                self.far.send(sent)
            self.line.step()
            self.hear()

    def hear(self) -> None:
        for chunk in [] if self.far is None else self.far.receive():
            self.rover.receive(chunk)
