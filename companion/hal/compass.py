"""Compasses: NMEA 0183, and the BNO055 on I²C."""

import math
from collections.abc import Callable
from typing import Protocol

from companion.config import parts
from companion.core.errors import HardwareError
from companion.core.units import wrap_pi
from companion.hal.background import Background
from companion.hal.bno055 import Bno055, Bno055Sample
from companion.hal.i2c import open_i2c
from companion.hal.interfaces import Port
from companion.hal.nmea_part import NmeaPart, open_nmea_port
from companion.sensors.nmea import Sentence
from companion.sensors.nmea_heading import HEADING_SENTENCES, HeadingAssembler
from companion.sensors.readings import HeadingReading

_BNO055_PERIOD_S = 0.04


class NmeaCompass:
    """Satisfies `companion.hal.interfaces.Compass`. For HDM, correction_rad includes the local variation."""

    def __init__(self, port: Port, now: Callable[[], float], correction_rad: float = 0.0) -> None:
        self._assembler = HeadingAssembler(correction_rad)
        self._latest: HeadingReading | None = None
        self.part = NmeaPart(port, now, HEADING_SENTENCES, self._ingest)

    def read(self) -> HeadingReading | None:
        """The latest reading, None before the first."""
        return self._latest

    def close(self) -> None:
        """Stop the thread and close the port. May be called twice."""
        self.part.close()

    def _ingest(self, sentence: Sentence, time_s: float) -> None:
        reading = self._assembler.feed(sentence, time_s)
        if reading is not None:
            self._latest = reading


def open_nmea_compass(part: parts.CompassPart, now: Callable[[], float]) -> NmeaCompass:
    """Open the compass on its port and start reading.

    Raises:
        ConfigError: the port url is invalid.
        LinkError: the port cannot be opened.
    """
    compass = NmeaCompass(open_nmea_port(part.port, part.baud, now), now, part.correction_rad)
    compass.part.start()
    return compass


class Bno055Part(Protocol):
    """The register interface."""

    def read(self) -> Bno055Sample | None: ...
    def set_up(self) -> None: ...
    def close(self) -> None: ...


class Bno055Compass:
    """Satisfies `companion.hal.interfaces.Compass`.

    The part lies flat with z up: its heading grows clockwise and its z rate is positive counter-clockwise
    (Bosch data sheet BST-BNO055-DS000), so the rate changes sign. Its north is magnetic; correction_rad
    includes variation and mounting angle. Headings are used only after the magnetometer has been calibrated
    since power-up: before, they start at zero in any direction.
    """

    def __init__(self, part: Bno055Part, now: Callable[[], float], correction_rad: float = 0.0) -> None:
        self._part = part
        self._now = now
        self._correction_rad = correction_rad
        self._knows_north = False
        self._latest: HeadingReading | None = None
        self._background = Background(self.step, "BNO055")

    def start(self) -> None:
        """Begin to read the part in a thread."""
        self._background.start()

    def step(self) -> float:
        """Read the part once; returns the seconds to wait before the next reading."""
        sample = self._part.read()
        if sample is None:
            # A supply dip resets the part to configuration mode.
            self._knows_north = False
            self._part.set_up()
        elif not self._knows_north:
            self._knows_north = sample.magnet > 0
        elif 0.0 <= sample.heading_deg <= 360.0:  # reject corrupted transfers
            heading_rad = wrap_pi(math.radians(sample.heading_deg) + self._correction_rad)
            roll_rad, pitch_rad = math.radians(sample.roll_deg), math.radians(sample.pitch_deg)
            rate_rad_s = -sample.yaw_rate_rad_s
            self._latest = HeadingReading(self._now(), heading_rad, rate_rad_s, roll_rad, pitch_rad)
        return _BNO055_PERIOD_S

    def read(self) -> HeadingReading | None:
        """The latest reading, None before the first."""
        return self._latest

    def close(self) -> None:
        """Stop the thread and close the bus. May be called twice."""
        self._background.close()
        self._part.close()


def open_bno055(part: parts.CompassPart, now: Callable[[], float]) -> Bno055Compass:
    """Open the part on the Pi's I²C bus and start reading.

    Raises:
        HardwareError: smbus2 is missing, there is no bus, or the part does not answer.
    """
    bus = open_i2c("BNO055")
    try:
        compass = Bno055Compass(Bno055(bus, part.address), now, part.correction_rad)
    except OSError as error:
        bus.close()
        if isinstance(error, HardwareError):
            raise
        raise HardwareError(f"BNO055: no answer at I²C address {part.address:#x}: {error}") from error
    compass.start()
    return compass
