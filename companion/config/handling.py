"""How a hull answers its thrusters: what guidance and control plan with."""

from companion.config.section import NonNegative, Positive, Section


class Handling(Section, frozen=True):
    """Figures of one hull, measured afloat. The defaults are those of a metre of hull on two thrusters."""

    top_speed_m_s: Positive = 3.0  # through the water, at full throttle
    surge_time_s: Positive = 1.0  # until throttle taken back shows in the speed
    turn_rate_rad_s: Positive = 0.65  # that full steering reaches under way
    yaw_time_s: Positive = 0.6  # until the bow follows the heading that is asked for
    slip_m: NonNegative = 0.4  # a turning hull slides outward by this times its turn rate
