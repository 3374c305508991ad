"""Orders of survey of the IHO's S-44, edition 6.1.0 (2022), table 1: what each allows at 95 % confidence."""

from typing import Final

import numpy as np

from mission_tools.bathymetry.soundings import Floats

ORDERS: Final = {"special": (0.25, 0.0075), "1a": (0.5, 0.013), "1b": (0.5, 0.013), "2": (1.0, 0.023)}
"""a in metres and b of the total vertical uncertainty; 1a and 1b differ in the coverage that they ask for."""


def tvu_m(order: str, depth_m: Floats) -> Floats:
    """The total vertical uncertainty that an order allows at depths: sqrt(a² + (b·depth)²)."""
    a_m, b = ORDERS[order]
    return np.hypot(a_m, b * depth_m)
