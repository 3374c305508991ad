"""Configuration of the sensors inside the hull."""

from typing import Literal

from companion.config.board import OptionalPin
from companion.config.section import Positive, Section


class HullPart(Section, frozen=True):
    """The computer's thermometer, and a leak switch to ground.

    leak_wet: what water does to the switch. One that water opens reads wet when its wire breaks, too.
    """

    driver: Literal["host", "none"] = "none"
    thermometer: str = "/sys/class/thermal/thermal_zone0/temp"
    timeout_s: Positive = 5.0  # without a reading it is silent: five at its 1 Hz
    leak: OptionalPin = -1  # the switch's pin; −1: none
    leak_wet: Literal["closed", "open"] = "closed"
