"""Driver, line and u-blox receiver, on a clock moved by hand."""

from companion.core.readings import GnssFix
from companion.hal.gnss.ubx import UbxGnss
from companion.links.memory import MemoryPort, memory_pair
from companion.sensors.gnss_heading import GnssHeading
from companion.sensors.ubx.setup import Phase, UbxSetup
from twins.lines import HandClock
from twins.ubx_receiver import NEO_M8N, Model, UbxReceiver

STEP_S = 0.02


class BaudLine:
    """A serial line in memory to a receiver. Bytes at another baud rate arrive garbled."""

    def __init__(self, receiver: UbxReceiver) -> None:
        self.receiver = receiver
        self.baud: int | None = None  # of the host
        near, self._far = memory_pair(is_datagram=False)
        self.port = MemoryPort(near)

    def set_baud(self, baud: int) -> None:
        """The host sets its end."""
        self.baud = baud

    def pump(self, now_s: float) -> None:
        """Move the bytes of both directions."""
        before = self.receiver.baud
        for data in self._far.receive():
            if self.receiver.baud in (None, self.baud):
                self.receiver.hear(data)
        data = self.receiver.run(now_s)
        if self.baud not in (None, before) and before is not None:
            data = bytes((7 * byte + 13) & 0xFF for byte in data[::2])
        if data:
            self._far.send(data)


class Bench:
    """A boat's receiver and what came of it."""

    def __init__(
        self,
        model: Model = NEO_M8N,
        *,
        interface: str = "UART1",
        baud: int | None = None,
        rate_hz: float = 5.0,
        heading: GnssHeading | None = None,
        target_baud: int | None = 115_200,
        is_usb: bool = False,
    ) -> None:
        self.clock = HandClock()
        self.receiver = UbxReceiver(model, interface=interface, baud=baud)
        self.line = BaudLine(self.receiver)
        setup = UbxSetup(target_baud, rate_hz, wants_baseline=heading is not None, is_usb=is_usb)
        self.line.baud = target_baud
        self.gnss = UbxGnss(self.line.port, self.clock, setup, 0.05, heading, self.line.set_baud)
        self.texts: list[str] = []
        self.fixes: list[GnssFix] = []

    @property
    def phase(self) -> Phase:
        return self.gnss.setup.phase

    def run(self, seconds: float) -> "Bench":
        for _ in range(round(seconds / STEP_S)):
            self.clock.advance(STEP_S)
            self.line.pump(self.clock())
            self.gnss.step()
            self.texts += [text for _, text in self.gnss.take_texts()]
            fix = self.gnss.read()
            if fix is not None and (not self.fixes or fix is not self.fixes[-1]):
                self.fixes.append(fix)
        return self

    def until_running(self, limit_s: float = 30.0) -> float:
        began_s = self.clock()
        while not any("set up" in text for text in self.texts):
            assert self.clock() - began_s < limit_s, (self.phase, self.texts)
            self.run(STEP_S)
        return self.clock() - began_s
