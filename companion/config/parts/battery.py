"""Configuration of the battery monitor."""

from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import Positive, Section


class BatteryPart(Section, frozen=True):
    """Battery monitor."""

    driver: Literal["ina219", "none"] = "none"
    address: Annotated[int, Meta(ge=0x08, le=0x77)] = 0x40
    shunt_ohm: Positive = 0.1  # the board's shunt; beyond 0.32 V over it the current is unknown
