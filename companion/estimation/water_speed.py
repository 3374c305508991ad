"""Speed of the hull through the water, from the motor commands.

Drag and thrust balance at cruise speed: `cruise_throttle` holds `cruise_m_s`. With x the speed and s a motor
command in those units, and X(x) = l x + (1 − l) x|x| for both drag and thrust (linear and quadratic damping,
T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed. 2021, section 6.4),

    ẋ = (½ X(s_left) + ½ X(s_right) − X(x)) / (X'(1) T) + 1.5 v r        T: time constant at cruise speed
    v̇ = −½ u r − v / T_v

The last terms are the Coriolis forces of the hull and its added mass (section 6.5), with a lateral added mass
of half the hull's mass: in a turn the hull slips outward and slows down.
"""

from typing import Final

_LINEAR: Final = 0.4
_QUADRATIC: Final = 1.0 - _LINEAR
_STEEPNESS: Final = 2.0 - _LINEAR  # X'(1)
_SLIDE: Final = 0.5
_SLOWED: Final = 1.5
_SWAY_SHARE: Final = 0.2  # T_v / T
_ASTERN: Final = 0.65  # of the thrust ahead: propellers are less efficient astern
_MAX_SHARE: Final = 4.0  # of cruise speed
_MAX_STEP_S: Final = 0.1


class WaterSpeed:
    """Surge (ahead) and sway (to starboard) through the water in m/s, and the surge acceleration."""

    def __init__(self) -> None:
        self.surge_m_s = self.surge_m_s2 = 0.0
        self.sway_m_s = 0.0

    def update(
        self,
        left: float,
        right: float,
        yaw_rate_rad_s: float,
        cruise_m_s: float,
        cruise_throttle: float,
        surge_time_s: float,
        dt_s: float,
    ) -> None:
        """Advance by dt_s with the commands left and right, −1..1. cruise_throttle = 0 disables the model."""
        if not cruise_throttle > 0.0:
            self.surge_m_s = self.surge_m_s2 = self.sway_m_s = 0.0
            return
        u, v = self.surge_m_s, self.sway_m_s
        if left == 0.0 == right and u == 0.0 == v:
            return
        dt_s = min(dt_s, _MAX_STEP_S, surge_time_s)
        a, b, x = left / cruise_throttle, right / cruise_throttle, u / cruise_m_s
        ahead = a * (_LINEAR + _QUADRATIC * a) if a >= 0.0 else _ASTERN * a * (_LINEAR - _QUADRATIC * a)
        ahead += b * (_LINEAR + _QUADRATIC * b) if b >= 0.0 else _ASTERN * b * (_LINEAR - _QUADRATIC * b)
        drag = x * (_LINEAR + _QUADRATIC * (x if x >= 0.0 else -x))
        gained = (
            cruise_m_s * (0.5 * ahead - drag) / (_STEEPNESS * surge_time_s) + _SLOWED * v * yaw_rate_rad_s
        )
        self.surge_m_s2 = gained
        limit = _MAX_SHARE * cruise_m_s
        slid = (v - dt_s * _SLIDE * u * yaw_rate_rad_s) / (1.0 + dt_s / (_SWAY_SHARE * surge_time_s))
        u += dt_s * gained
        self.surge_m_s = limit if u > limit else -limit if u < -limit else u
        self.sway_m_s = limit if slid > limit else -limit if slid < -limit else slid
