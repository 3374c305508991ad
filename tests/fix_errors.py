"""Errors of a receiver whose scatter the filter knows."""

from companion.estimation.fix_error import VELOCITY_M_S, FixError


def scatter(sigma_m: float, velocity_m_s: float = VELOCITY_M_S) -> FixError:
    """Of this deviation an axis, four fifths of it coloured over a minute; white of the velocity."""
    wander_m2 = 0.64 * sigma_m * sigma_m
    return FixError(sigma_m * sigma_m - wander_m2, wander_m2, 60.0, velocity_m_s * velocity_m_s)
