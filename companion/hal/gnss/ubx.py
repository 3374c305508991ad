"""u-blox GNSS receiver, set up and read with the UBX protocol."""

import math
import os
from collections.abc import Callable, Iterator
from typing import Final

from companion.config.sensors import GnssPart
from companion.core.readings import GnssFix
from companion.hal.gnss.receiver import GnssReceiver
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.links.serial_port import SerialPort
from companion.sensors.gnss_heading import GnssHeading
from companion.sensors.ubx.frames import NAV_RELPOSNED, UbxFrame, UbxReader
from companion.sensors.ubx.messages import UbxFixAssembler, baseline
from companion.sensors.ubx.setup import UbxSetup

# 10 Hz of NAV-PVT, NAV-DOP and NAV-RELPOSNED are 1980 bytes/s; 115,200 baud carry 11,520.
_BAUD: Final = 115_200
_USB: Final = "ttyACM"  # devices with a USB port of their own, not behind a serial adapter
_REST_S: Final = 0.01  # a UART hands over a NAV-PVT in a dozen pieces
_PVT_LIFE_S: Final = 2.0  # sentences are used in place of older NAV-PVT


class UbxGnss(GnssReceiver):
    """Sets the receiver up, again whenever it falls silent. Without an answer, NMEA sentences are used."""

    def __init__(
        self,
        port: Port,
        now: Callable[[], float],
        setup: UbxSetup,
        latency_s: float = 0.0,
        heading: GnssHeading | None = None,
        set_baud: Callable[[int], None] | None = None,
    ) -> None:
        """set_baud: changes the baud rate of the port; None if it has none."""
        super().__init__(port, now, latency_s, heading, setup.baud, _REST_S)
        self.setup = setup
        self.frames = UbxReader()
        self._set_baud = set_baud
        self._pvt_s = -math.inf
        self._assembler = UbxFixAssembler(latency_s)

    def step(self) -> None:
        super().step()
        setup = self.setup
        if self._links:
            setup.tick(self._now())
        if setup.baud != self._baud:
            self._baud = setup.baud
            if self._set_baud is not None and setup.baud is not None:
                self._set_baud(setup.baud)
            self._drop_partial()
        for frame in setup.take_outbox():
            for link in self._links:
                link.send(frame)
        for severity, text in setup.take_texts():
            self.notify(severity, text)

    def _may_inject(self) -> bool:
        return self.setup.may_inject

    def _decode(self, chunk: bytes, time_s: float) -> Iterator[GnssFix]:
        frames, between = self.frames.feed(chunk)
        for frame in frames:
            fix = self._on_frame(frame, time_s)
            if fix is not None:
                yield self._with_heading(fix, time_s)
        accepted = self.reader.accepted
        for fix in self._read_sentences(between, time_s):
            if time_s - self._pvt_s > _PVT_LIFE_S:
                yield fix
        if self.reader.accepted > accepted:
            self.setup.on_sentence(time_s)

    def _on_frame(self, frame: UbxFrame, time_s: float) -> GnssFix | None:
        self.setup.on_frame(frame, time_s)
        if frame.kind == NAV_RELPOSNED and self.heading is not None:
            found = baseline(frame.payload)
            if found is not None:
                self.heading.on_baseline(found, time_s)
        fix = self._assembler.feed(frame, time_s)
        if fix is not None:
            self._pvt_s = time_s
        return fix

    def _forget(self) -> None:
        self._drop_partial()
        self.setup.restart(self._now())

    def _drop_partial(self) -> None:
        self.reader.forget()
        self.frames.forget()


def open_ubx_gnss(part: GnssPart, now: Callable[[], float], heading: GnssHeading | None = None) -> UbxGnss:
    """Open the receiver's port and start its set-up. Raises as `open_line`.

    heading: of its two antennas, if they are used.
    """
    baud = int(part.baud) or _BAUD
    port = open_line(part.port, baud, now)
    set_baud = port.set_baud if isinstance(port, SerialPort) else None
    setup = UbxSetup(
        None if set_baud is None else baud,
        part.rate_hz,
        wants_baseline=heading is not None,
        is_usb=_USB in os.path.realpath(part.port),
    )
    return UbxGnss(port, now, setup, part.latency_s, heading, set_baud).start()
