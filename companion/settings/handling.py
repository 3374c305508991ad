"""How a hull answers its thrusters: what guidance and control plan with."""

from companion.section import NonNegative, Positive, Section, Share


class Handling(Section, frozen=True):
    """Figures of one hull, measured afloat. The defaults are those of a metre of hull on two thrusters."""

    top_speed_m_s: Positive = 3.0  # through the water, at full throttle
    surge_time_s: Positive = 1.0  # until throttle taken back shows in the speed
    turn_rate_rad_s: Positive = 0.9  # that full steering reaches on the spot
    yaw_time_s: Positive = 0.5  # until the bow follows the heading that is asked for
    slip_m: NonNegative = 0.4  # in a turn the hull slides outward by this times its turn rate
    yaw_damping_m: NonNegative = 0.0  # steering that a turn takes, more per m/s: see `control/heading.py`
    deadband_ahead: Share = 0.0  # of command, that only hums
    deadband_astern: Share = 0.0
