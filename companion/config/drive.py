"""Layout of the drive: which actuators the boat has, and what a rudder does."""

from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share


class DriveSetting(Section, frozen=True):
    """layout: two motors side by side; one motor (the left channel) and a rudder; or two motors and a rudder.

    The rest describes the rudder. Its yaw moment is proportional to its angle, up to the stall near 35°,
    where the linkage must end, and to the square of the water's speed at the blade. Full rudder at cruise
    speed is the full steering effort of the heading loop. The square of the speed at the blade, in shares of
    that at cruise, is

        (1 − wash) (u / cruise speed)² + wash (throttle / cruise throttle)²        throttle ahead only

    wash: how much of it at cruise is propeller wash; 0 if the blade lies outside the wash. astern: moment
    going astern relative to ahead. steerage_m_s: below this speed through the water the helm adds throttle
    for wash over the rudder. kick_throttle: most throttle that it adds. turn_radius_m: smallest turning
    radius under way, with some rudder left to steer.
    """

    layout: Literal["differential", "rudder", "differential_rudder"] = "differential"
    wash: Share = 0.5
    astern: Share = 0.3
    steerage_m_s: NonNegative = 0.6
    kick_throttle: Share = 0.5
    turn_radius_m: Positive = 3.0
    slew_per_s: Annotated[float, Meta(gt=0.0, le=50.0)] = 3.0  # of the rudder, amidships to one end is 1

    @property
    def has_rudder(self) -> bool:
        """Whether a rudder steers."""
        return self.layout != "differential"

    @property
    def has_pair(self) -> bool:
        """Whether two motors can turn the boat."""
        return self.layout != "rudder"

    @property
    def can_pivot(self) -> bool:
        """Whether the boat turns on the spot."""
        return self.layout != "rudder"

    @property
    def least_radius_m(self) -> float:
        """The smallest turning radius: 0 on the spot."""
        return 0.0 if self.can_pivot else self.turn_radius_m


DIFFERENTIAL = DriveSetting()
