"""The hull: surge, sway and yaw after T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion
Control*, 2nd edition, Wiley 2021.

With ν = [u v r] the velocity *through the water* in the body frame (u ahead, v to starboard, r clockwise), a
current of velocity (Vn, Ve) over ground and the heading ψ, the model is

    M ν̇ + C(ν) ν + D(ν) ν = τ                    chapter 6.5, manoeuvring model in relative velocity
    η̇ = R(ψ) ν + [Vn Ve 0]                        chapter 10.3, irrotational current

The first line may be written in relative velocity alone where the current is steady and irrotational
(Property 10.1): the boat does not feel it, it is only carried. Over a step and a hull's length the current
is taken as that; from step to step it may change, see `feel`. Rigid body and added mass are taken about a
centre of gravity amidships, so M = diag(m − Xu̇, m − Yv̇, Iz − Nṙ) = diag(m11, m22, m33) (chapter 6.3), and
C(ν) in its skew-symmetric form leaves

    m11 u̇ = X +  m22 v r            − (Xu + Xuu|u|) u
    m22 v̇ = Y −  m11 u r            − Yv v                 − F       − ∫ c |v + x r| (v + x r) dx
    m33 ṙ = N + (m11 − m22) u v     − (Nr + Nrr|r|) r      + a F     − ∫ c |v + x r| (v + x r) x dx

Damping is linear plus quadratic (chapter 6.4). F = k |u| (v − a r) is the lift of the skeg, a fin at the
distance a abaft the centre: k = ½ ρ A ∂C_L/∂α times the speed ahead times the sideways speed of the fin. It
keeps the Munk moment (m11 − m22) u v from swinging the hull broadside.

The integrals are the cross-flow drag of the hull's strips (chapter 6.4, cross-flow drag principle; O. M.
Faltinsen, *Sea Loads on Ships and Offshore Structures*, 1990, chapter 6), c = ½ ρ T C_d of each. With c
even over a stretch of 2 h amidships they have a closed form. Let Yvv = 2 h c, t = h |r| the tips' speed and
s = v / t:

    where |s| ≥ 1:   Yvv (v|v| + sgn(v) t²/3)       ⅔ Yvv h² |v| r
    where |s| < 1:   Yvv v t (1 + s²/3)              ½ Yvv h t² sgn(r) (½ + s² − s⁴/6)

So pure sway meets Yvv v|v| and pure yaw ¼ Yvv h³ r|r|. All of D is dissipative and C does no work, so an
unpowered hull never gains energy.
"""

import math

from companion.section import NonNegative, Positive, Section
from sitl.windage import WindageParameters

LONGEST_STEP_S = 0.05


class VesselParameters(Section, frozen=True):
    """One hull, all SI.

    Added masses are positive: −Xu̇, −Yv̇ in kg and −Nṙ in kg m². Damping coefficients are positive too:
    linear ones in N per m/s (N m per rad/s for yaw), quadratic ones per their square. sway_quadratic is Yvv
    above, spread over crossflow_length_m = 2 h amidships, less than the hull's length where its draught
    tapers to the ends; yaw_quadratic is what the strips do not account for. The skeg's lift is k above in
    kg/m, its arm a in m abaft the centre.

    Raises:
        ValueError: the hull is wider than long, its strips reach beyond it, or it is so light for its
        damping that
            a step of 50 ms is unstable.
    """

    mass_kg: Positive
    length_m: Positive
    beam_m: Positive
    inertia_kg_m2: Positive
    surge_added_kg: NonNegative
    sway_added_kg: NonNegative
    yaw_added_kg_m2: NonNegative
    surge_linear: Positive
    surge_quadratic: NonNegative
    sway_linear: NonNegative
    sway_quadratic: NonNegative
    crossflow_length_m: Positive
    yaw_linear: Positive
    yaw_quadratic: NonNegative = 0.0
    skeg_lift_kg_m: NonNegative = 0.0
    skeg_arm_m: NonNegative = 0.0
    windage: WindageParameters = WindageParameters()

    def __post_init__(self) -> None:
        """Check what no single field can tell."""
        super().__post_init__()
        if self.beam_m > self.length_m:
            raise ValueError("beam_m must not exceed length_m")
        if self.crossflow_length_m > self.length_m:
            raise ValueError("crossflow_length_m must not exceed length_m")
        rates = (
            self.surge_linear / (self.mass_kg + self.surge_added_kg),
            self.sway_linear / (self.mass_kg + self.sway_added_kg),
            self.yaw_linear / (self.inertia_kg_m2 + self.yaw_added_kg_m2),
        )
        if max(rates) * LONGEST_STEP_S > 1.0:
            raise ValueError(f"damping stops this hull within {1.0 / max(rates):.3f} s, faster than a step")


class Vessel:
    """The hull's motion, stepped by the explicit midpoint rule (second-order Runge-Kutta).

    A boat's step is 20 ms and its fastest time constant some tenths of a second, far inside the rule's
    stability limit (rate × step < 2). Its error falls with the square of the step, at half the cost of the
    fourth-order rule, whose further digits would drown in the damping coefficients' uncertainty.

    The velocity (surge_m_s, sway_m_s, yaw_rate_rad_s) is through the water; heading_rad grows without
    wrapping.
    """

    __slots__ = (
        "_crossflow", "_half_strips_m", "_m11", "_m22", "_m33", "_mass_kg", "_munk", "_nr", "_nrr", "_skeg",
        "_skeg_arm", "_xu", "_xuu", "_yv",
        "east_m", "heading_rad", "north_m", "surge_m_s", "sway_m_s", "yaw_rate_rad_s",
    )  # fmt: skip

    def __init__(
        self,
        parameters: VesselParameters,
        north_m: float = 0.0,
        east_m: float = 0.0,
        heading_rad: float = 0.0,
    ) -> None:
        """Put a hull at rest into the water."""
        self._mass_kg = parameters.mass_kg
        self._m11 = parameters.mass_kg + parameters.surge_added_kg
        self._m22 = parameters.mass_kg + parameters.sway_added_kg
        self._m33 = parameters.inertia_kg_m2 + parameters.yaw_added_kg_m2
        self._munk = self._m11 - self._m22
        self._xu, self._xuu = parameters.surge_linear, parameters.surge_quadratic
        self._yv, self._crossflow = parameters.sway_linear, parameters.sway_quadratic
        self._half_strips_m = 0.5 * parameters.crossflow_length_m
        self._nr, self._nrr = parameters.yaw_linear, parameters.yaw_quadratic
        self._skeg, self._skeg_arm = parameters.skeg_lift_kg_m, parameters.skeg_arm_m
        self.north_m, self.east_m, self.heading_rad = north_m, east_m, heading_rad
        self.surge_m_s = self.sway_m_s = self.yaw_rate_rad_s = 0.0

    @property
    def energy_j(self) -> float:
        """Kinetic energy of hull and entrained water, ½ νᵀ M ν, in the water's frame."""
        u, v, r = self.surge_m_s, self.sway_m_s, self.yaw_rate_rad_s
        return 0.5 * (self._m11 * u * u + self._m22 * v * v + self._m33 * r * r)

    def _acceleration(
        self, u: float, v: float, r: float, surge_n: float, sway_n: float, yaw_nm: float
    ) -> tuple[float, float, float]:
        speed, sideways = abs(u), abs(v)
        half = self._half_strips_m
        tip = half * abs(r)
        if sideways >= tip:
            drag_n = self._crossflow * (sideways * sideways + tip * tip / 3.0)
            if v < 0.0:
                drag_n = -drag_n
            drag_nm = self._crossflow * half * half * sideways * r / 1.5
        else:
            share = v / tip
            square = share * share
            drag_n = self._crossflow * v * tip * (1.0 + square / 3.0)
            drag_nm = self._crossflow * half * tip * tip * (0.25 + 0.5 * square - square * square / 12.0)
            if r < 0.0:
                drag_nm = -drag_nm
        lift = self._skeg * speed * (v - self._skeg_arm * r)
        return (
            (surge_n + self._m22 * v * r - (self._xu + self._xuu * speed) * u) / self._m11,
            (sway_n - self._m11 * u * r - self._yv * v - drag_n - lift) / self._m22,
            (
                yaw_nm
                + self._munk * u * v
                - (self._nr + self._nrr * abs(r)) * r
                - drag_nm
                + self._skeg_arm * lift
            )
            / self._m33,
        )

    def step(
        self,
        surge_n: float,
        sway_n: float,
        yaw_nm: float,
        current_north_m_s: float,
        current_east_m_s: float,
        dt_s: float,
    ) -> None:
        """Advance by dt_s under constant forces, ahead and to starboard, and a constant clockwise moment."""
        u, v, r = self.surge_m_s, self.sway_m_s, self.yaw_rate_rad_s
        half = 0.5 * dt_s
        du, dv, dr = self._acceleration(u, v, r, surge_n, sway_n, yaw_nm)
        um, vm, rm = u + half * du, v + half * dv, r + half * dr
        du, dv, dr = self._acceleration(um, vm, rm, surge_n, sway_n, yaw_nm)
        heading = self.heading_rad + half * r
        cos, sin = math.cos(heading), math.sin(heading)
        self.north_m += dt_s * (um * cos - vm * sin + current_north_m_s)
        self.east_m += dt_s * (um * sin + vm * cos + current_east_m_s)
        self.heading_rad += dt_s * rm
        self.surge_m_s = u + dt_s * du
        self.sway_m_s = v + dt_s * dv
        self.yaw_rate_rad_s = r + dt_s * dr

    def feel(self, north_m_s: float, east_m_s: float) -> None:
        """The current around the hull has changed by this much over ground.

        The rigid body keeps its velocity over ground, the added mass its velocity through the water: with
        M_RB the rigid body's mass, M Δν = −M_RB Δν_c (chapter 10.3, equations of relative motion before
        Property 10.1).
        """
        cos, sin = math.cos(self.heading_rad), math.sin(self.heading_rad)
        self.surge_m_s -= self._mass_kg / self._m11 * (north_m_s * cos + east_m_s * sin)
        self.sway_m_s -= self._mass_kg / self._m22 * (east_m_s * cos - north_m_s * sin)

    def velocity_m_s(self, current_north_m_s: float, current_east_m_s: float) -> tuple[float, float]:
        """Velocity over ground, north and east."""
        u, v = self.surge_m_s, self.sway_m_s
        cos, sin = math.cos(self.heading_rad), math.sin(self.heading_rad)
        return u * cos - v * sin + current_north_m_s, u * sin + v * cos + current_east_m_s

    def run_aground(
        self, north_m: float, east_m: float, current_north_m_s: float, current_east_m_s: float
    ) -> None:
        """Stop over ground at a place; the hull may still turn."""
        self.north_m, self.east_m = north_m, east_m
        cos, sin = math.cos(self.heading_rad), math.sin(self.heading_rad)
        self.surge_m_s = -current_north_m_s * cos - current_east_m_s * sin
        self.sway_m_s = current_north_m_s * sin - current_east_m_s * cos
