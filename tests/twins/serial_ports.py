"""All serial ports of a computer, with parts at their far ends that speak at one rate only."""

import random
from collections.abc import Callable
from pathlib import Path

import pytest

from companion.core.errors import LinkError
from companion.links.memory import MemoryLink, MemoryPort, memory_pair
from companion.links.serial_port import LINE_8N1, LineFormat
from twins.lines import HandClock
from twins.ubx_messages import sentence
from twins.ubx_receiver import Model, UbxReceiver

STEP_S = 0.05
RMC = sentence("GNRMC,092720.00,A,5030.0,N,00112.0,W,2.0,90.0,280524,,,A")
Speak = Callable[[float], bytes]


class Device:
    """A part at the far end. speak: what it says at a time; hear: answers the host."""

    def __init__(
        self,
        baud: int,
        speak: Speak,
        hear: Callable[[bytes], bytes | None] = lambda _: b"",
        line: LineFormat = LINE_8N1,
    ) -> None:
        self.baud, self.speak, self.hear, self.line = baud, speak, hear, line


class SerialBench:
    """The computer's serial ports. At another rate than a part's, bytes arrive garbled both ways."""

    def __init__(self, root: Path) -> None:
        self.clock, self.devices = HandClock(), dict[str, Device]()
        self.refused: dict[str, str] = {}
        self.written: list[tuple[str, float]] = []
        self.began_s = self.clock()
        self._root, self._open = root, list[tuple[str, Device, MemoryLink, bool]]()
        (root / "dev").mkdir(exist_ok=True)

    def plug_in(self, name: str, device: Device, link: str = "") -> None:
        (self._root / "dev" / name).touch()
        self.devices[name] = device
        if link:
            path = self._root / "dev" / link
            path.parent.mkdir(parents=True, exist_ok=True)
            path.symlink_to(self._root / "dev" / name)

    def open(self, path: str, baud: int, _: Callable[[], float], line: LineFormat) -> MemoryPort:
        name = Path(path).resolve().name
        if name in self.refused:
            raise LinkError(self.refused[name])
        near, far = memory_pair(is_datagram=False)
        device = self.devices[name]
        self._open.append((name, device, far, (baud, line) == (device.baud, device.line)))
        return MemoryPort(near)

    def wait(self, _: float) -> None:
        self.clock.advance(STEP_S)
        for name, device, far, is_clear in self._open:
            if far.is_closed:
                continue
            said = device.speak(self.clock())
            if said:
                far.send(said if is_clear else random.Random(1).randbytes(len(said)))
            for data in far.receive():
                self.written.append((name, self.clock() - self.began_s))
                if is_clear and (answer := device.hear(data)):
                    far.send(answer)
        self._open = [one for one in self._open if not one[2].is_closed]


def plug_in_ports(monkeypatch: pytest.MonkeyPatch, root: Path) -> SerialBench:
    """In place of the computer's own ports. No gpsd runs."""
    bench = SerialBench(root)
    monkeypatch.setattr("companion.app.init.serial_parts.SerialPort", bench.open)
    monkeypatch.setattr("companion.app.init.serial_parts.GPSD", ("127.0.0.1", 1))
    monkeypatch.setattr("companion.hal.raspberry_pi.ROOT", root)
    return bench


def every_s(period_s: float, data: bytes) -> Speak:
    """As often as it is due since the call before."""
    sent = [100.0]

    def speak(now_s: float) -> bytes:
        count = int((now_s - sent[0]) / period_s + 1e-6)
        sent[0] += count * period_s
        return data * count

    return speak


def receiver(model: Model) -> Device:
    twin = UbxReceiver(model)
    assert twin.baud is not None
    return Device(twin.baud, twin.run, twin.hear)
