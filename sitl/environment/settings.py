"""The scenario's table [environment]."""

import math

from companion.section import NonNegative, Positive, Section


class Environment(Section, frozen=True):
    """Current and wind. All of it acts whether the boat is armed or not.

    current_to_deg is where the current flows *to*, wind_from_deg where the wind comes *from*, as sailors say
    both; degrees clockwise from north. wind_m_s is the mean at the hull's height, which over water is two
    thirds of what a forecast gives for 10 m. gust_m_s is what the gusts peak at within ten minutes, 0 for a
    wind without any; gust_s is their correlation time.

    Raises:
        ValueError: gusts that are weaker than the mean wind.
    """

    current_m_s: NonNegative = 0.0
    current_to_deg: float = 0.0
    wind_m_s: NonNegative = 0.0
    wind_from_deg: float = 0.0
    gust_m_s: NonNegative = 0.0
    gust_s: Positive = 4.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if 0.0 < self.gust_m_s < self.wind_m_s:
            raise ValueError(
                f"gust_m_s = {self.gust_m_s:g}: expected at least wind_m_s = {self.wind_m_s:g}, or 0 for none"
            )

    @property
    def current_north_m_s(self) -> float:
        """The current's northward part."""
        return self.current_m_s * math.cos(math.radians(self.current_to_deg))

    @property
    def current_east_m_s(self) -> float:
        """The current's eastward part."""
        return self.current_m_s * math.sin(math.radians(self.current_to_deg))
