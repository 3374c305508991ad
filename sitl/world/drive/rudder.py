"""The rudder: a low-aspect blade behind the propeller, and its servo.

After T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd edition, Wiley 2021,
section 9.5, and A. F. Molland and S. R. Turnock, *Marine Rudders and Control Surfaces*, Elsevier 2007. With A
the blade's area, α its angle to the water, V the water's speed at the blade and a its distance abaft the
centre,

    L = ½ ρ A V² C_L        C_L = 1.95 π α / (1 + 3/Λ)        up to the stall      (chapter 5, Λ: aspect)
    D = ½ ρ A V² C_D        C_D = C_D0 + C_L² / (0.9 π Λ)

Beyond the stall C_L falls to STALLED_SHARE of its peak within STALLING_RAD, and C_D goes on as a plate's. The
propeller wash is that of an actuator disc of area A_p and thrust T (section 3.6): far behind the disc
V_∞² = u² + 2 T / (ρ A_p), of whose increase the share WASH has been reached at the blade. The share `washed`
of the blade lies in it:

    V² = washed (u + WASH (V_∞ − u))² + (1 − washed) u²

A propeller that turns astern sends no wash aft. Going astern the blade is swept from its trailing edge, with
ASTERN of the lift and the opposite sign of its angle. The hull's sway and yaw turn the inflow.
"""

import math
from typing import Final

from companion.config.section import Positive, Section, Share
from sitl.world.drive.propeller import WATER_KG_M3

WASH: Final = 0.9  # half a diameter to one diameter behind the disc (Gutsche's formula: 0.85 to 0.95)
ASTERN: Final = 0.5
STALLED_SHARE: Final = 0.6
STALLING_RAD: Final = math.radians(10.0)
_FRICTION: Final = 0.02  # C_D0
_PLATE: Final = 1.2  # drag coefficient of a plate across the flow


class RudderSettings(Section, frozen=True):
    """The blade and its servo. aspect: effective, up to twice span over chord under a flat stern."""

    area_m2: Positive
    arm_m: Positive  # abaft amidships
    aspect: Positive = 2.0
    max_deg: Positive = 35.0
    stall_deg: Positive = 30.0
    washed: Share = 0.7
    servo_deg_s: Positive = 150.0  # of the blade


class Rudder:
    """angle_rad: positive turns the bow to starboard under way ahead.

    Faults: fitted is 0 for a blade that is lost or trails freely; is_stuck holds the angle; offset_rad.
    """

    def __init__(self, parameters: RudderSettings, disc_m2: float) -> None:
        """disc_m2: of the propeller ahead of it."""
        self._half_rho_area = 0.5 * WATER_KG_M3 * parameters.area_m2
        self._arm_m, self._washed = parameters.arm_m, parameters.washed
        self._slope = 1.95 * math.pi / (1.0 + 3.0 / parameters.aspect)
        self._induced = 1.0 / (0.9 * math.pi * parameters.aspect)
        self._max_rad, self._stall_rad = math.radians(parameters.max_deg), math.radians(parameters.stall_deg)
        self._rate_rad_s = math.radians(parameters.servo_deg_s)
        self._thrust_speed = 2.0 / (WATER_KG_M3 * disc_m2)
        self.angle_rad = 0.0
        self.fitted = 1.0
        self.is_stuck = False
        self.offset_rad = 0.0

    def step(
        self,
        share: float,
        thrust_n: float,
        surge_m_s: float,
        sway_m_s: float,
        yaw_rate_rad_s: float,
        dt_s: float,
    ) -> tuple[float, float, float]:
        """Turn the blade for dt_s towards a share of its largest angle; the force ahead, the force to
        starboard and the clockwise moment.
        """
        if not self.is_stuck:
            wanted, most = share * self._max_rad, self._rate_rad_s * dt_s
            self.angle_rad += min(max(wanted - self.angle_rad, -most), most)
        angle, u = self.angle_rad + self.offset_rad, surge_m_s
        aside_m_s = sway_m_s - self._arm_m * yaw_rate_rad_s
        wash = u
        if thrust_n > 0.0:
            # Moving astern, the wash meets the water that comes from behind.
            far = math.sqrt(u * u + self._thrust_speed * thrust_n)
            wash = u + WASH * (far - u)
        square = self._washed * wash * abs(wash) + (1.0 - self._washed) * u * abs(u)
        along_m_s = math.sqrt(abs(square))
        if along_m_s < 1e-6:
            return 0.0, 0.0, 0.0
        size = self._half_rho_area * (along_m_s * along_m_s + aside_m_s * aside_m_s) * self.fitted
        inflow = math.atan2(aside_m_s, along_m_s)
        lift, drag = self._coefficients(angle + inflow if square > 0.0 else inflow - angle)
        if square < 0.0:
            lift *= ASTERN
        # Lift is across the inflow, drag along it.
        c, s = math.cos(inflow), math.sin(inflow)
        ahead = size * (lift * s - drag * c)
        if square < 0.0:
            ahead = -ahead
        starboard = -size * (lift * c + drag * s)
        return ahead, starboard, -self._arm_m * starboard

    def _coefficients(self, attack_rad: float) -> tuple[float, float]:
        """C_L, with the sign of the angle of attack, and C_D."""
        attack = abs(attack_rad)
        lift = self._slope * min(attack, self._stall_rad)
        beyond = attack - self._stall_rad
        plate = 0.0
        if beyond > 0.0:
            lift *= 1.0 - (1.0 - STALLED_SHARE) * min(beyond / STALLING_RAD, 1.0)
            lift *= max(math.cos(attack) / math.cos(self._stall_rad), 0.0)  # none across the flow
            plate = _PLATE * (math.sin(attack) ** 2 - math.sin(self._stall_rad) ** 2)
        drag = _FRICTION + self._induced * lift * lift + max(plate, 0.0)
        return math.copysign(lift, attack_rad), drag
