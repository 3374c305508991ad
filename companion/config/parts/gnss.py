"""Configuration of the GNSS receiver."""

from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section


class GnssPart(Section, frozen=True):
    """A receiver with NMEA 0183 output, a u-blox receiver (ubx), which is set up at start, or gpsd.

    port: a device, another port url, or HOST:PORT of gpsd.

    latency_s: shortest time from measurement to first sentence. rate_hz: to which a u-blox receiver is set.
    With two antennas, baseline_m is their distance (0: any), and antenna_bearing_rad the direction from the
    reference antenna to the receiver's own, clockwise from the bow.
    """

    driver: Literal["nmea", "ubx", "gpsd", "none"] = "none"
    port: str = "/dev/serial0"
    # 0: 9600 for nmea; for ubx the receiver is set to 115200, whatever its rate is at first
    baud: NonNegative = 0.0
    rate_hz: Annotated[float, Meta(ge=1.0, le=20.0)] = 5.0
    baseline_m: NonNegative = 0.0
    antenna_bearing_rad: float = 0.0
    timeout_s: Positive = 4.0  # without a fix the receiver is silent: as ArduPilot; four of one a second
    latency_s: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.1  # ArduPilot assumes 0.12 to 0.22 for u-blox
