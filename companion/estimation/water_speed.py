"""How fast the hull moves through the water, from what the motors were told.

Drag and thrust balance at the speed that the speed loop's feed-forward is for: `cruise_throttle` holds
`cruise_m_s`. With x the speed and s a motor's command in those units, and X(x) = l x + (1 − l) x|x| for drag
and thrust alike (linear and quadratic damping, T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and
Motion Control*, 2nd ed. 2021, section 6.4),

    ẋ = (½ X(s_left) + ½ X(s_right) − X(x)) / (X'(1) T) + 1.5 v r        T: time constant at cruise speed
    v̇ = −½ u r − v / T_v

The last terms are the Coriolis forces of the hull and the water that moves along with it (section 6.5), with
half the hull's mass of water sideways: in a turn the hull slides outward and loses way.
"""

from typing import Final

_LINEAR: Final = 0.4
_STEEPNESS: Final = 2.0 - _LINEAR  # X'(1)
_SLIDE: Final = 0.5
_SLOWED: Final = 1.5
_SWAY_SHARE: Final = 0.2  # T_v / T
_ASTERN: Final = 0.65  # of the thrust ahead: propellers bite less astern
_MAX_SHARE: Final = 4.0  # of cruise speed
_MAX_STEP_S: Final = 0.1


class WaterSpeed:
    """Surge (ahead) and sway (to starboard) through the water, m/s, and how fast the surge changes."""

    __slots__ = ("surge_m_s", "surge_m_s2", "sway_m_s")

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
        """Go on by dt_s with these commands, −1..1 per side. A throttle of 0 for cruise means no model."""
        if not cruise_throttle > 0.0:
            self.surge_m_s = self.surge_m_s2 = self.sway_m_s = 0.0
            return
        dt_s = min(dt_s, _MAX_STEP_S, surge_time_s)
        u, v, r = self.surge_m_s, self.sway_m_s, yaw_rate_rad_s
        drive = 0.5 * (_thrust(left / cruise_throttle) + _thrust(right / cruise_throttle))
        gained = cruise_m_s * (drive - _force(u / cruise_m_s)) / (_STEEPNESS * surge_time_s) + _SLOWED * v * r
        self.surge_m_s2 = gained
        limit = _MAX_SHARE * cruise_m_s
        self.surge_m_s = min(max(u + dt_s * gained, -limit), limit)
        slid = v - dt_s * _SLIDE * u * r
        self.sway_m_s = min(max(slid / (1.0 + dt_s / (_SWAY_SHARE * surge_time_s)), -limit), limit)


def _thrust(share: float) -> float:
    """Of one motor, in the same units."""
    return _force(share) if share >= 0.0 else _ASTERN * _force(share)


def _force(share: float) -> float:
    """Drag or thrust of a share of cruise speed or throttle, in shares of the drag at cruise speed."""
    return share * (_LINEAR + (1.0 - _LINEAR) * abs(share))
