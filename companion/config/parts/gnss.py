"""Configuration of the GNSS receiver."""

from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import Positive, Section


class GnssPart(Section, frozen=True):
    """An NMEA 0183 receiver. latency_s: shortest time from measurement to first sentence."""

    driver: Literal["nmea", "none"] = "none"
    port: str = "/dev/serial0"
    baud: Positive = 9600
    latency_s: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.1  # ArduPilot assumes 0.12 to 0.22 for u-blox
