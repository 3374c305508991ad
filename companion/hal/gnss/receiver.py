"""What all GNSS receivers on a port share: NMEA sentences, the heading of two antennas, and corrections."""

from collections import deque
from collections.abc import Callable, Iterator
from typing import Final

from companion.config.sensors import GnssPart
from companion.core.readings import GnssFix
from companion.hal.port_sensor import PortSensor
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.links.serial_port import SerialPort
from companion.sensors.gnss_heading import GnssHeading
from companion.sensors.nmea.fix import GNSS_SENTENCES, FixAssembler
from companion.sensors.nmea.heading import TRUE_SENTENCES, HeadingAssembler
from companion.sensors.nmea.sentences import NmeaReader, Sentence
from companion.sensors.receiver_clock import ReceiverClock
from companion.sensors.silence import SilenceMonitor

_BITS_A_BYTE: Final = 10  # start, eight, stop
_NETWORK_BYTES_S: Final = 11_520.0  # of a receiver behind a network port, as at 115,200 baud
_LONGEST_WAIT_S: Final = 1.0  # corrections come once a second; later ones are better than more


class GnssReceiver(PortSensor[GnssFix]):
    """Satisfies `companion.hal.interfaces.Gnss` and `CorrectionInput`; reads NMEA 0183 sentences.

    Fixes are stamped with the time of measurement, from the receiver's time of day.
    """

    def __init__(
        self,
        port: Port,
        now: Callable[[], float],
        latency_s: float = 0.0,
        heading: GnssHeading | None = None,
        baud: int | None = None,
        rest_s: float = 0.0,
    ) -> None:
        """latency_s: shortest time from measurement to the arrival of the first sentence.

        heading: None without a second antenna. baud: None for a line without a baud rate.
        """
        super().__init__(port, now, rest_s)
        self.heading = heading
        self.reader = NmeaReader(GNSS_SENTENCES | (TRUE_SENTENCES if heading is not None else frozenset()))
        self._fixes = FixAssembler()
        self._headings = HeadingAssembler()
        self._clock = ReceiverClock(latency_s)
        self._baud = baud
        self._corrections: deque[bytes] = deque()
        self._injected_bytes, self._injected_s = 0.0, 0.0  # as far as the line has not carried them yet
        self._listeners: dict[str, Callable[[Sentence, float], None]] = {}

    def listen(self, kinds: frozenset[str], ingest: Callable[[Sentence, float], None]) -> None:
        """Pass sentences of these kinds, which are not the receiver's own, to another; in its thread."""
        self._listeners.update(dict.fromkeys(kinds, ingest))
        self.reader.want(kinds)

    def inject(self, data: bytes) -> bool:
        """Send corrections; False beyond what the line carries. Called in the boat's thread."""
        now_s, rate = self._now(), self._line_bytes_s
        waiting = max(self._injected_bytes - rate * (now_s - self._injected_s), 0.0)
        self._injected_bytes, self._injected_s = waiting, now_s
        if waiting + len(data) > rate * _LONGEST_WAIT_S:
            return False
        self._injected_bytes += len(data)
        self._corrections.append(data)
        return True

    @property
    def _line_bytes_s(self) -> float:
        """What the line to the receiver carries."""
        return self._baud / _BITS_A_BYTE if self._baud else _NETWORK_BYTES_S

    def step(self) -> None:
        """Process received bytes, and send corrections. Never waits."""
        super().step()
        if self.heading is not None:
            self.heading.tick(self._now(), self.notify)
        for _ in range(len(self._corrections)):
            data = self._corrections.popleft()
            for link in self._links if self._may_inject() else ():
                link.send(data)

    def _may_inject(self) -> bool:
        """Whether the receiver takes corrections now."""
        return True

    def _read_sentences(self, data: bytes, time_s: float) -> Iterator[GnssFix]:
        for sentence in self.reader.feed(data):
            if (ingest := self._listeners.get(sentence.kind)) is not None:
                ingest(sentence, time_s)
            elif sentence.kind not in TRUE_SENTENCES:
                for fix in self._fixes.feed(sentence, time_s):
                    yield self._with_heading(self._clock.stamp(fix), time_s)
            elif self.heading is not None and (reading := self._headings.feed(sentence, time_s)) is not None:
                self.heading.on_sentence(reading)

    def _with_heading(self, fix: GnssFix, time_s: float) -> GnssFix:
        return fix if self.heading is None else self.heading.added_to(fix, time_s)

    def _forget(self) -> None:
        self.reader.forget()


_BAUD: Final = 9600  # of most receivers as delivered
_SILENT_S: Final = 5.0  # receivers send once a second at least, most also without a fix


class NmeaGnss(GnssReceiver):
    """A receiver that is used as it is. Tells when nothing is heard, or no sentence in what is heard."""

    def __init__(
        self,
        port: Port,
        now: Callable[[], float],
        latency_s: float = 0.0,
        heading: GnssHeading | None = None,
        baud: int | None = None,
    ) -> None:
        super().__init__(port, now, latency_s, heading, baud)
        self._sentence_s = now()  # of the latest sentence, at first of the start
        self._noise_bytes = 0  # since then
        self._silence = SilenceMonitor("GNSS receiver")

    def step(self) -> None:
        super().step()
        now_s = self._now()
        is_heard = now_s - self._sentence_s <= _SILENT_S
        what = "sends no sentences; check parts.gnss.baud" if self._noise_bytes else "is silent"
        if text := self._silence.update(0.0, now_s, is_heard=is_heard, what=what):
            self.notify(*text)

    def _decode(self, chunk: bytes, time_s: float) -> Iterator[GnssFix]:
        before = self.reader.accepted + self.reader.skipped
        yield from self._read_sentences(chunk, time_s)
        if self.reader.accepted + self.reader.skipped > before:
            self._sentence_s, self._noise_bytes = time_s, 0
        else:
            self._noise_bytes += len(chunk)


def open_nmea_gnss(part: GnssPart, now: Callable[[], float], heading: GnssHeading | None = None) -> NmeaGnss:
    """Open the receiver on its port and start reading. Raises as `open_line`.

    heading: of its two antennas, if they are used.
    """
    baud = int(part.baud) or _BAUD
    port = open_line(part.port, baud, now)
    line_baud = baud if isinstance(port, SerialPort) else None
    return NmeaGnss(port, now, part.latency_s, heading, line_baud).start()
