"""The wind's force on what stands above the water, after T. I. Fossen, *Handbook of Marine Craft
Hydrodynamics and Motion Control*, 2nd edition, Wiley 2021, chapter 10.1.

With V the speed of the air past the hull and γ the angle at which it meets the bow, the forces on a hull
that is symmetrical fore and aft are

    X = −½ ρ V² c_x cos γ A_F        Y = ½ ρ V² c_y sin γ A_L        N = ½ ρ V² c_n sin 2γ A_L L

(the same chapter, wind coefficients for symmetrical ships: c_x 0.5–0.9, c_y 0.7–0.95, c_n 0.05–0.20), and
where the centre of the lateral area lies ahead of amidships, N grows by that lever times Y. Written with
the air's velocity past the hull in body axes, (u ahead, v to starboard), no angle is left:

    X = ½ ρ c_x A_F V u              Y = ½ ρ c_y A_L V v             N = −ρ c_n A_L L u v + lever Y

How much that is on a real boat: a printed hull of 1 m × 0.35 m and 8 kg floats some 5 cm deep and shows about
9 cm of side, a hatch or electronics box of 30 × 10 cm, and a mast with antenna: 0.14 m² from the side and
0.05 m² from ahead. A beam wind of 8 m/s then pushes with 5 N, which moves the drifting hull at 5 % of the
wind; ahead it takes 1.6 N of the thrusters' seven. Small boats are all windage: that is not to be made
light of.
"""

import math

from sitl.world.hull_settings import WindageSettings

AIR_KG_M3 = 1.225


class Windage:
    """The force of air on one hull."""

    def __init__(self, parameters: WindageSettings, length_m: float) -> None:
        half = 0.5 * AIR_KG_M3
        self._x = half * parameters.frontal_drag * parameters.frontal_area_m2
        self._y = half * parameters.lateral_drag * parameters.lateral_area_m2
        self._n = 2.0 * half * parameters.turning * parameters.lateral_area_m2 * length_m
        self._lever_m = parameters.lever_m

    def force(self, ahead_m_s: float, starboard_m_s: float) -> tuple[float, float, float]:
        """Surge force, sway force in N and yaw moment in N m of air that moves past the hull at a velocity.

        The velocity is the air's relative to the hull, in body axes: a headwind has ahead_m_s < 0.
        """
        speed_m_s = math.sqrt(ahead_m_s * ahead_m_s + starboard_m_s * starboard_m_s)
        sway_n = self._y * speed_m_s * starboard_m_s
        return (
            self._x * speed_m_s * ahead_m_s,
            sway_n,
            -self._n * ahead_m_s * starboard_m_s + self._lever_m * sway_n,
        )
