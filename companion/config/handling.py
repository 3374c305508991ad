"""Hull response to the thrusters, for guidance and control."""

from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section


class Handling(Section, frozen=True):
    """Figures of the hull, measured on the water. Defaults: a hull of one metre with two thrusters."""

    top_speed_m_s: Annotated[float, Meta(ge=0.05, le=20.0)] = 3.0  # at full throttle; the pool boat: 0.07
    surge_time_s: Positive = 1.0  # delay from throttle to speed
    turn_rate_rad_s: Positive = 0.65  # at full steering under way
    yaw_time_s: Positive = 0.6  # delay from demanded heading to heading
    slip_m: NonNegative = 0.4  # outward slip in a turn, per turn rate
