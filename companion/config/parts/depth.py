"""Configuration of the depth sounder."""

from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share


class DepthPart(Section, frozen=True):
    """A depth sounder: NMEA 0183 (DPT, DBT, MTW) on a port of its own or among the sentences of the GNSS
    receiver, or a Ping1D.
    """

    driver: Literal["nmea", "gnss", "ping1d", "none"] = "none"
    port: str = "/dev/ttyUSB2"
    baud: Annotated[int, Meta(ge=0)] = 0  # 0: 4800 for NMEA, 115,200 for the Ping1D
    timeout_s: Positive = 5.0  # without a sounding it is silent: five sentences of an NMEA sounder
    transducer_m: NonNegative = 0.0  # its depth below the surface; 0: as the sounder says
    min_range_m: NonNegative = 0.3
    max_range_m: Positive = 100.0
    # Ping1D only
    sound_m_s: Annotated[float, Meta(ge=1300.0, le=1700.0)] = 1480.0  # fresh water at 20 °C; the sea 1500
    min_confidence: Share = 0.5  # readings below it found no bottom
