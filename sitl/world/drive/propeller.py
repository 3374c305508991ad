"""The fixed-pitch propeller in open water, after T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and
Motion Control*, 2nd edition, Wiley 2021, chapter 9 (open-water characteristics, bilinear thruster model).

With n the revolutions per second, D the diameter, u_a the speed of the water that it meets and J = u_a / (n
D),

    T = ρ D⁴ K_T(J) n|n|        K_T = K_T0 (1 − J / J_T)        so   T = T_nn n|n| − T_nu |n| u_a
    Q = ρ D⁵ K_Q(J) n|n|        K_Q = K_Q0 (1 − J / J_Q)        and  Q = Q_nn n|n| − Q_nu |n| u_a

Straight lines are what measured curves look like between bollard pull and no thrust. Astern the blades'
back does the work: weaker thrust for the same torque.
"""

import math

from companion.config.section import Positive, Section, Share

WATER_KG_M3 = 1000.0
_PER_RADIAN = 1.0 / (2.0 * math.pi)


class PropellerSettings(Section, frozen=True):
    """K_T0, K_Q0, J_T and J_Q above, and the share of thrust that is left astern.

    depth_m is how deep the shaft lies below the still surface: where waves or trim bring it nearer than the
    blades reach, it sucks air. Raises ValueError: somewhere between bollard pull and no thrust it would give
    more power than it takes.
    """

    diameter_m: Positive
    thrust_coefficient: Positive
    torque_coefficient: Positive
    zero_thrust_advance: Positive
    zero_torque_advance: Positive
    astern_share: Share = 0.55
    depth_m: Positive = 0.06

    def __post_init__(self) -> None:
        super().__post_init__()
        # Q ω − T u_a ≥ 0 for all n and u_a is a quadratic in n / u_a that must not have two roots.
        torque = 2.0 * math.pi * self.torque_coefficient
        middle = torque / self.zero_torque_advance + self.thrust_coefficient
        if middle * middle > 4.0 * torque * self.thrust_coefficient / self.zero_thrust_advance:
            raise ValueError(
                "the propeller gives more power than it takes: expected a larger torque_coefficient"
            )


class Propeller:
    """Its four coefficients over the shaft's speed ω in rad/s.

    Thrust = thrust_nn ω|ω| − thrust_nu |ω| u_a in N, torque = torque_nn ω|ω| − torque_nu |ω| u_a in N m;
    astern, astern_nn takes the place of thrust_nn.
    """

    def __init__(self, parameters: PropellerSettings) -> None:
        area = WATER_KG_M3 * parameters.diameter_m**3
        turned = _PER_RADIAN * _PER_RADIAN * parameters.diameter_m
        thrust, torque = (
            area * parameters.thrust_coefficient,
            area * parameters.diameter_m * parameters.torque_coefficient,
        )
        self.thrust_nn = thrust * turned
        self.thrust_nu = thrust * _PER_RADIAN / parameters.zero_thrust_advance
        self.torque_nn = torque * turned
        self.torque_nu = torque * _PER_RADIAN / parameters.zero_torque_advance
        self.astern_nn = parameters.astern_share * self.thrust_nn
