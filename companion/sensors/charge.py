"""Battery charge: integrated from the current, and from the voltage at rest."""

from itertools import pairwise

from companion.core.readings import BatteryReading
from companion.core.units import clamp

# Open-circuit voltage of a resting LiPo cell against the charge left: (share, volt)
_LIPO_CURVE = (
    (0.0, 3.27),
    (0.05, 3.61),
    (0.1, 3.69),
    (0.2, 3.73),
    (0.4, 3.79),
    (0.6, 3.87),
    (0.8, 4.02),
    (1.0, 4.2),
)

# A LiPo cell at rest: from empty, less a little for the load of the computer, to full
_RESTING_V = (3.2, 4.25)
_NOMINAL_V = 3.7

_MAX_GAP_S = 2.0  # longer gaps between readings are skipped


class ChargeCounter:
    """Integrates the battery current by the trapezoidal rule."""

    def __init__(self) -> None:
        self.consumed_mah = 0.0
        self._last: BatteryReading | None = None

    def add(self, reading: BatteryReading | None) -> None:
        """Add a reading; a repeated one has no effect."""
        last = self._last
        if reading is None or reading.current_a is None:
            return
        if last is not None and last.current_a is not None:
            gap_s = reading.time_s - last.time_s
            if gap_s <= 0.0:
                return
            if gap_s <= _MAX_GAP_S:
                self.consumed_mah += 0.5 * (reading.current_a + last.current_a) * gap_s / 3.6
        self._last = reading


def resting_share(cell_v: float) -> float:
    """Charge of a LiPo cell at rest, 0..1. Under load it reads slightly low."""
    for (low_share, low_v), (high_share, high_v) in pairwise(_LIPO_CURVE):
        if cell_v < high_v:
            return clamp(low_share + (high_share - low_share) * (cell_v - low_v) / (high_v - low_v), 0.0, 1.0)
    return 1.0


def cells_fault(voltage_v: float, cells: int) -> str:
    """Why a resting pack cannot have this number of cells, "" if it can."""
    low_v, high_v = _RESTING_V
    if low_v <= voltage_v / cells <= high_v:
        return ""
    likely = round(voltage_v / _NOMINAL_V)
    fits = likely > 0 and likely != cells and low_v <= voltage_v / likely <= high_v
    return f"Battery: {voltage_v:.1f} V does not fit {cells} cells" + (f", but {likely}" if fits else "")
