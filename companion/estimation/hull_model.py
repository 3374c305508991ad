"""Process model: how thrust and steering move the hull through the water.

Surge and sway. Drag and thrust balance at cruise speed U: `cruise_throttle` holds `cruise_m_s`. With x the
speed and s a motor command in those units, and X(x) = l x + (1 − l) x|x| for both drag and thrust (linear
and quadratic damping, T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed.
2021, section 6.4),

    u̇ = U (g ½ (X(s_left) + X(s_right)) − X(u/U)) / (X'(1) T) + (1 + a) v r
    v̇ = −a u r − v / T_v        T: time constant at U; g: thrust gain, 1 nominally

The last terms of the first line and the first of the second are the Coriolis forces of the hull and its
added mass (section 6.5), with a lateral added mass of a hulls: in a turn the hull slips outward and slows.
"""

import math
from typing import Final

# l: CyberShip II, 1.26 m, has 0.44 at 0.3 m/s and 0.33 at 0.4 m/s (R. Skjetne, T. I. Fossen, P. V. Kokotović,
# Automatica 41, 2005: X_u −0.72, X_|u|u −1.33, X_uuu −5.87)
_LINEAR: Final = 0.4
_ADDED: Final = 0.5  # a, in hull masses
_SWAY_SHARE: Final = 0.2  # T_v / T: drag across is that of a bluff body
# Of the thrust ahead. 0.78 for a propeller in a duct that works both ways (Blue Robotics T200, 16 V: 4.1 of
# 5.25 kgf); an open one with cambered blades has less, 0.5 to 0.7
_ASTERN: Final = 0.65
GAIN: Final = 0.2  # initial deviation of the gains g and K, as a share,
GAIN_WALK: Final = 0.005  # and their walk per √s: battery voltage falls, and thrust is not the model's


def _thrust(x: float) -> float:
    push = x * (_LINEAR + (1.0 - _LINEAR) * abs(x))
    return push if x >= 0.0 else _ASTERN * push


class SurgeModel:
    """sway_m_s is v above. slope: ∂u̇/∂u; per_gain: ∂u̇/∂g; accel_m_s2: u̇; slip_m_s2: a u r; all of the last
    step.
    """

    def __init__(self, cruise_m_s: float, cruise_throttle: float, surge_time_s: float) -> None:
        """cruise_throttle = 0 disables thrust."""
        self._cruise_m_s, self._throttle = cruise_m_s, cruise_throttle
        self._most_m_s = (
            cruise_m_s / cruise_throttle if cruise_throttle > 0.0 else math.inf
        )  # at full throttle
        self._rate = 1.0 / ((2.0 - _LINEAR) * surge_time_s)  # 1 / (X'(1) T)
        self._sway_s = _SWAY_SHARE * surge_time_s
        self.sway_m_s = self.accel_m_s2 = self.slip_m_s2 = self.per_gain = 0.0
        self.slope = -_LINEAR * self._rate

    def advance(
        self, surge_m_s: float, yaw_rate_rad_s: float, left: float, right: float, gain: float, dt_s: float
    ) -> float:
        """Surge after dt_s with the commands left and right, −1..1. Drag is implicit: any step is stable."""
        u, v, rate = surge_m_s, self.sway_m_s, self._rate
        thrust = 0.0
        if self._throttle > 0.0:
            thrust = 0.5 * (_thrust(left / self._throttle) + _thrust(right / self._throttle))
        size = abs(u) / self._cruise_m_s
        self.per_gain = per_gain = self._cruise_m_s * rate * thrust
        self.slope = -rate * (_LINEAR + 2.0 * (1.0 - _LINEAR) * size)
        push = gain * per_gain + (1.0 + _ADDED) * v * yaw_rate_rad_s
        after = (u + dt_s * push) / (1.0 + dt_s * rate * (_LINEAR + (1.0 - _LINEAR) * size))
        after = min(max(after, -self._most_m_s), self._most_m_s)
        self.accel_m_s2 = (after - u) / dt_s if dt_s > 0.0 else 0.0
        self.slip_m_s2 = _ADDED * u * yaw_rate_rad_s
        self.sway_m_s = (v - dt_s * self.slip_m_s2) / (1.0 + dt_s / self._sway_s)
        return after
