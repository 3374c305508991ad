"""Configuration of the heading sensor."""

from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import Positive, Section


class CompassPart(Section, frozen=True):
    """A heading sensor: NMEA 0183, or a BNO055 on I²C. The correction is added to its heading."""

    driver: Literal["nmea", "bno055", "none"] = "none"
    port: str = "/dev/ttyUSB0"
    baud: Positive = 4800
    correction_rad: float = 0.0
    address: Annotated[int, Meta(ge=0x08, le=0x77)] = 0x28  # of the BNO055; 0x29 where its COM3 pin is high
