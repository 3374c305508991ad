"""Orders of survey of the IHO's S-44, edition 6.1.0 (2022), table 1: what each allows at 95 % confidence."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from mission_tools.bathymetry.soundings import Floats


@dataclass(frozen=True, slots=True)
class Order:
    """a_m, b: of the total vertical uncertainty sqrt(a² + (b·depth)²); thu_m, thu_share: of the horizontal
    one, thu_m + thu_share·depth.
    """

    a_m: float
    b: float
    thu_m: float
    thu_share: float

    def tvu_m(self, depth_m: Floats) -> Floats:
        """The vertical uncertainty allowed at depths, 95 %."""
        return np.hypot(self.a_m, self.b * depth_m)


ORDERS: Final = {
    "special": Order(0.25, 0.0075, 2.0, 0.0),
    "1a": Order(0.5, 0.013, 5.0, 0.05),
    "1b": Order(0.5, 0.013, 5.0, 0.05),
    "2": Order(1.0, 0.023, 20.0, 0.1),
}
"""By name, strictest first. 1a and 1b differ in the coverage that they ask for, not in uncertainty."""
