"""Ground truth of the emulated boat, as figures, recorders and faults use it."""

from typing import NamedTuple


class Truth(NamedTuple):
    """Ground truth, which the boat does not see.

    Position in the scenario's frame; heading in [−π, π), clockwise from north; surge and sway through the
    water, ahead and to starboard; north_m_s and east_m_s over ground; grounded: it touched the shore within
    the last second, or sticks there. Current and wind are the velocities of water (averaged over the waves)
    and air over ground at the boat; the commands are those that stand at the motors, −1..1; voltage and
    current are the pack's.
    """

    time_s: float
    north_m: float
    east_m: float
    heading_rad: float
    surge_m_s: float
    sway_m_s: float
    yaw_rate_rad_s: float
    north_m_s: float
    east_m_s: float
    left_thrust_n: float
    right_thrust_n: float
    grounded: bool
    current_north_m_s: float = 0.0
    current_east_m_s: float = 0.0
    wind_north_m_s: float = 0.0
    wind_east_m_s: float = 0.0
    left_command: float = 0.0
    right_command: float = 0.0
    voltage_v: float = 0.0
    current_a: float = 0.0
