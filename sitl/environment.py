"""The water's own motion."""

import math

from companion.section import NonNegative, Section


class Environment(Section, frozen=True):
    """A steady, uniform current; its direction is where it flows *to*, degrees clockwise from north."""

    current_m_s: NonNegative = 0.0
    current_to_deg: float = 0.0

    @property
    def current_north_m_s(self) -> float:
        """The current's northward part."""
        return self.current_m_s * math.cos(math.radians(self.current_to_deg))

    @property
    def current_east_m_s(self) -> float:
        """The current's eastward part."""
        return self.current_m_s * math.sin(math.radians(self.current_to_deg))
