"""The hull: surge, sway and yaw after T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion
Control*, 2nd edition, Wiley 2021.

With ν = [u v r] the velocity *through the water* in the body frame (u ahead, v to starboard, r clockwise), a
current of velocity (Vn, Ve) over ground and the heading ψ, the model is

    M ν̇ + C(ν) ν + D(ν) ν = τ                    chapter 6.5, manoeuvring model in relative velocity
    η̇ = R(ψ) ν + [Vn Ve 0]                        chapter 10.3, irrotational current

The first line may be written in relative velocity alone where the current is steady and irrotational
(Property 10.1): the boat does not feel it, it is only carried. Over a step and a hull's length the current
is taken as such; between steps it may change (`Hull.enter_current`). Rigid body and added mass are taken
about a centre of gravity amidships, so M = diag(m − Xu̇, m − Yv̇, Iz − Nṙ) = diag(m11, m22, m33) (chapter
6.3), and C(ν) in its skew-symmetric form leaves

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

from sitl.world.hull_settings import HullSettings


class Hull:
    """The hull's motion.

    Velocities are stepped by the two-step Adams-Bashforth rule on all that depends on them, with the forces
    from outside held over the step; positions by the trapezoidal rule. Both err with the square of the
    step. A boat's step is 20 ms and its fastest time constant some tenths of a second, far inside the
    rule's stability limit (rate × step < 1). One evaluation a step is half the cost of a two-stage rule,
    and further digits would drown in the damping coefficients' uncertainty.

    The velocity (surge_m_s, sway_m_s, yaw_rate_rad_s) is through the water, and so is its resolution into
    (water_north_m_s, water_east_m_s); heading_rad grows without wrapping, cos and sin are its own.
    """

    def __init__(
        self,
        parameters: HullSettings,
        north_m: float = 0.0,
        east_m: float = 0.0,
        heading_rad: float = 0.0,
    ) -> None:
        """Put a hull at rest into the water."""
        self._m11 = parameters.mass_kg + parameters.surge_added_kg
        self._m22 = parameters.mass_kg + parameters.sway_added_kg
        self._m33 = parameters.inertia_kg_m2 + parameters.yaw_added_kg_m2
        self._munk = self._m11 - self._m22
        self._xu, self._xuu = parameters.surge_linear, parameters.surge_quadratic
        self._yv, self._crossflow = parameters.sway_linear, parameters.sway_quadratic
        self._half_strips_m = 0.5 * parameters.crossflow_length_m
        self._nr, self._nrr = parameters.yaw_linear, parameters.yaw_quadratic
        self._skeg, self._skeg_arm = parameters.skeg_lift_kg_m, parameters.skeg_arm_m
        self._bend_u = self._bend_v = self._bend_r = 0.0
        self.surge_m_s = self.sway_m_s = self.yaw_rate_rad_s = 0.0
        self.place(north_m, east_m, heading_rad)
        self.move(0.0, 0.0, 0.0)

    @property
    def inertia(self) -> tuple[float, float, float]:
        """m11 and m22 in kg, m33 in kg m²."""
        return self._m11, self._m22, self._m33

    def place(self, north_m: float, east_m: float, heading_rad: float) -> None:
        """Set the pose; the velocity in body axes stays."""
        self.north_m, self.east_m, self.heading_rad = north_m, east_m, heading_rad
        self.cos, self.sin = math.cos(heading_rad), math.sin(heading_rad)
        self._resolve()

    def move(self, surge_m_s: float, sway_m_s: float, yaw_rate_rad_s: float) -> None:
        """Set the velocity through the water, as a blow does; the next step starts afresh from it."""
        self.surge_m_s, self.sway_m_s, self.yaw_rate_rad_s = surge_m_s, sway_m_s, yaw_rate_rad_s
        self._is_fresh = True
        self._resolve()

    def hold(self, flow_north_m_s: float, flow_east_m_s: float) -> None:
        """Stay at rest over ground in water that flows like this."""
        surge_m_s = -flow_north_m_s * self.cos - flow_east_m_s * self.sin
        sway_m_s = flow_north_m_s * self.sin - flow_east_m_s * self.cos
        self.move(surge_m_s, sway_m_s, 0.0)

    def enter_current(self, north_m_s: float, east_m_s: float) -> None:
        """The hull has made way through the water to where the current is stronger by this much over ground.

        A floating body displaces its own mass, so that the pressure which accelerates the water accelerates
        the hull as well: one that drifts follows the water wherever it goes, and only its own way w through
        the water brings it into other water, dw/dt = −(w·∇) V (T. R. Auton, J. C. R. Hunt and M. Prud'homme,
        *The force exerted on a body in inviscid unsteady non-uniform rotational flow*, J. Fluid Mech. 197,
        1988, with displaced mass = mass). So the velocity over ground is kept as the hull crosses a shear.
        """
        self.surge_m_s -= north_m_s * self.cos + east_m_s * self.sin
        self.sway_m_s -= east_m_s * self.cos - north_m_s * self.sin
        self._resolve()

    def _resolve(self) -> None:
        self.water_north_m_s = self.surge_m_s * self.cos - self.sway_m_s * self.sin
        self.water_east_m_s = self.surge_m_s * self.sin + self.sway_m_s * self.cos

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
        speed, sideways, half = abs(u), abs(v), self._half_strips_m
        tip = half * abs(r)

        # The strips.
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

        # Accelerations that depend on the velocity.
        m11, m22 = self._m11, self._m22
        lift = self._skeg * speed * (v - self._skeg_arm * r)
        du = (m22 * v * r - (self._xu + self._xuu * speed) * u) / m11
        dv = (-m11 * u * r - self._yv * v - drag_n - lift) / m22
        dr = self._munk * u * v - (self._nr + self._nrr * abs(r)) * r - drag_nm + self._skeg_arm * lift
        dr /= self._m33
        if self._is_fresh:
            self._bend_u, self._bend_v, self._bend_r, self._is_fresh = du, dv, dr, False
        u += dt_s * (1.5 * du - 0.5 * self._bend_u + surge_n / m11)
        v += dt_s * (1.5 * dv - 0.5 * self._bend_v + sway_n / m22)
        turned = r + dt_s * (1.5 * dr - 0.5 * self._bend_r + yaw_nm / self._m33)
        self._bend_u, self._bend_v, self._bend_r = du, dv, dr
        self.surge_m_s, self.sway_m_s, self.yaw_rate_rad_s = u, v, turned

        # The pose.
        half = 0.5 * dt_s
        self.heading_rad = heading = self.heading_rad + half * (r + turned)
        self.cos = cos = math.cos(heading)
        self.sin = sin = math.sin(heading)
        north_m_s, east_m_s = u * cos - v * sin, u * sin + v * cos
        self.north_m += half * (self.water_north_m_s + north_m_s) + dt_s * current_north_m_s
        self.east_m += half * (self.water_east_m_s + east_m_s) + dt_s * current_east_m_s
        self.water_north_m_s, self.water_east_m_s = north_m_s, east_m_s
