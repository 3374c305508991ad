"""Configuration of the rudder."""

from typing import Literal

from companion.config.parts.pulses import PulseOutputSetting
from companion.config.section import Section


class RudderPart(Section, frozen=True):
    """The rudder's servo. Its longest pulse turns the bow to starboard, with `reversed` the shortest.

    min_us and max_us are the ends of the linkage, not of the servo: at most 35° of rudder, where it stalls.
    """

    driver: Literal["servo", "none"] = "none"
    signal: PulseOutputSetting = PulseOutputSetting(pin=13)
