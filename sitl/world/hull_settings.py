"""A hull in numbers: what `sitl.world.hull` and `sitl.world.windage` compute with."""

from companion.config.section import NonNegative, Positive, Section, Share

LONGEST_STEP_S = 0.05


class WindageSettings(Section, frozen=True):
    """What the hull shows to the wind. The lateral area's centre lies lever_m ahead of amidships."""

    frontal_area_m2: NonNegative = 0.05
    lateral_area_m2: NonNegative = 0.14
    frontal_drag: NonNegative = 0.8
    lateral_drag: NonNegative = 0.9
    turning: NonNegative = 0.08
    lever_m: float = 0.0


class HullSettings(Section, frozen=True):
    """One hull, all SI. transom_share is the stern's width over the beam; see `sitl.world.contact`.

    Added masses are positive: −Xu̇, −Yv̇ in kg and −Nṙ in kg m². Damping coefficients are positive too:
    linear ones in N per m/s (N m per rad/s for yaw), quadratic ones per their square. sway_quadratic is Yvv
    of `sitl.world.hull`, spread over crossflow_length_m = 2 h amidships: less than the hull's length where
    the draught tapers to the ends; yaw_quadratic is what the strips do not account for. The skeg's lift is k
    of the same text in kg/m, its arm a in m abaft the centre. Raises ValueError: the hull is wider than long,
    its strips reach beyond it, or it is so light for its damping that a step of 50 ms is unstable.
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
    transom_share: Share = 0.6
    windage: WindageSettings = WindageSettings()

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
