"""Tidal streams from harmonic constants (extra `tide`).

A constituent of angular speed ω, amplitude H and Greenwich phase lag g contributes f H cos(ω t + V + u − g),
with the astronomical argument V, the nodal corrections f and u, and ω of UTide (Codiga 2011, after Foreman
1977). These are taken at the beginning of each day and go on from there by ω. Across the direction of the
flood the same with minor / major and 90° later: the tidal ellipse (Foreman 1978).
"""

import functools
import math
from dataclasses import dataclass, field

import numpy as np

from mission_tools.costs.current_file import Floats
from mission_tools.costs.departure import KnownTimes

_DAY_S = 86400.0
_POSIX_DAY = 719163  # 1 January 1970 as UTide counts: 1 on 1 January of the year 1


@dataclass(frozen=True, slots=True)
class Constituent:
    """speed_m_s: the semi-major axis, to_deg: where the flood flows, phase_deg: Greenwich phase lag of its
    greatest speed; minor_m_s: the semi-minor axis, positive where the stream turns anticlockwise.
    """

    name: str
    speed_m_s: float
    to_deg: float
    phase_deg: float
    minor_m_s: float = 0.0


@dataclass(frozen=True, slots=True)
class TidalStream:
    """The same everywhere on a chart. Raises ValueError: an unknown constituent. ImportError: no UTide."""

    constituents: tuple[Constituent, ...]
    lat_deg: float
    times: KnownTimes = field(default=KnownTimes(is_dated=True), init=False)

    def __post_init__(self) -> None:
        from utide import constit_index_dict  # noqa: PLC0415 - the extra

        unknown = [one.name for one in self.constituents if one.name not in constit_index_dict]
        if unknown:
            raise ValueError(
                f"no tidal constituent {', '.join(unknown)}: expected names such as M2, S2, N2, K1, O1"
            )

    def at(self, north_m: Floats, east_m: Floats, time_s: Floats) -> tuple[Floats, Floats]:
        """The sum of all constituents."""
        day = math.floor(float(np.median(time_s)) / _DAY_S)
        arguments = _arguments(tuple(one.name for one in self.constituents), day, self.lat_deg)
        north_m_s, east_m_s = np.zeros(np.broadcast_shapes(north_m.shape, time_s.shape)), np.zeros(1)
        for one, (factor, argument_rad, rate_rad_s) in zip(self.constituents, arguments, strict=True):
            angle = argument_rad + rate_rad_s * (time_s - day * _DAY_S) - math.radians(one.phase_deg)
            along, left = factor * one.speed_m_s * np.cos(angle), factor * one.minor_m_s * np.sin(angle)
            to_rad = math.radians(one.to_deg)
            north_m_s = north_m_s + along * math.cos(to_rad) + left * math.sin(to_rad)
            east_m_s = east_m_s + along * math.sin(to_rad) - left * math.cos(to_rad)
        return north_m_s, east_m_s + 0.0 * east_m


@functools.lru_cache(maxsize=64)
def _arguments(names: tuple[str, ...], day: int, lat_deg: float) -> list[tuple[float, float, float]]:
    """Nodal factor f, argument V + u in rad at the day's beginning, and ω in rad/s, of each constituent."""
    from utide import constit_index_dict  # noqa: PLC0415 - the extra
    from utide.harmonics import FUV, linearized_freqs  # noqa: PLC0415

    which = np.array([constit_index_dict[name] for name in names])
    at = np.array([float(_POSIX_DAY + day)])
    factor, nodal, astronomical = (part[0] for part in FUV(at, at[0], which, lat_deg or 5.0, [1, 0, 1, 0]))
    rate = linearized_freqs(at[0])[which] * 2.0 * math.pi / 3600.0
    turned = (nodal + astronomical) * 2.0 * math.pi
    return list(zip(factor.tolist(), turned.tolist(), rate.tolist(), strict=True))
