"""The energy that a hull has."""

from sitl.world.hull import Hull


def energy_j(hull: Hull) -> float:
    """Kinetic energy of hull and entrained water, ½ νᵀ M ν, in the water's frame."""
    speeds = (hull.surge_m_s, hull.sway_m_s, hull.yaw_rate_rad_s)
    return 0.5 * sum(m * v * v for m, v in zip(hull.inertia, speeds, strict=True))
