"""What all GNSS receivers on a port share: NMEA sentences, the heading of two antennas, and corrections."""

from collections import deque
from collections.abc import Callable, Iterator
from typing import Final

from companion.hal.interfaces import Port
from companion.hal.port_sensor import PortSensor
from companion.sensors.gnss_heading import GnssHeading
from companion.sensors.nmea import NmeaReader
from companion.sensors.nmea_fix import GNSS_SENTENCES, FixAssembler
from companion.sensors.nmea_heading import TRUE_SENTENCES, HeadingAssembler
from companion.sensors.readings import GnssFix
from companion.sensors.receiver_clock import ReceiverClock

_MOST_FRAMES: Final = 32  # waiting corrections: two seconds of them, older ones are useless


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
        rest_s: float = 0.0,
    ) -> None:
        """latency_s: shortest time from measurement to the arrival of the first sentence.

        heading: None without a second antenna.
        """
        super().__init__(port, now, rest_s)
        self.heading = heading
        self.reader = NmeaReader(GNSS_SENTENCES | (TRUE_SENTENCES if heading is not None else frozenset()))
        self._fixes = FixAssembler()
        self._headings = HeadingAssembler()
        self._clock = ReceiverClock(latency_s)
        self._corrections: deque[bytes] = deque()

    def inject(self, data: bytes) -> bool:
        """Send corrections to the receiver; False if too many are waiting. Called in the boat's thread."""
        if len(self._corrections) >= _MOST_FRAMES:
            return False
        self._corrections.append(data)
        return True

    def step(self) -> None:
        """Process received bytes, and send corrections. Never waits."""
        super().step()
        if self.heading is not None:
            self.heading.tick(self._now(), self.notify)
        while self._corrections and self._may_inject():
            data = self._corrections.popleft()
            for link in self._links:
                link.send(data)

    def _may_inject(self) -> bool:
        """Whether the receiver takes corrections now."""
        return True

    def _read_sentences(self, data: bytes, time_s: float) -> Iterator[GnssFix]:
        for sentence in self.reader.feed(data):
            if sentence.kind not in TRUE_SENTENCES:
                for fix in self._fixes.feed(sentence, time_s):
                    yield self._with_heading(self._clock.stamp(fix), time_s)
            elif self.heading is not None and (reading := self._headings.feed(sentence, time_s)) is not None:
                self.heading.on_sentence(reading)

    def _with_heading(self, fix: GnssFix, time_s: float) -> GnssFix:
        return fix if self.heading is None else self.heading.added_to(fix, time_s)

    def _forget(self) -> None:
        self.reader.forget()
