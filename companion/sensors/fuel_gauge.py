"""State of charge of the battery pack, as shown to the operator.

With a current measurement, charge is counted down from the state at the first reading, at rest. Without one,
the open-circuit voltage is estimated: terminal voltage plus sag, where the sag is the motor load times
learned factors. A Kalman filter estimates both; Plett, "Battery Management Systems, Volume II", 2015, chapter
3, has such a model with a measured current.
"""

import math
from itertools import pairwise

from companion.config.boat_config import BatteryPack
from companion.core.readings import BatteryReading
from companion.core.state import MotorCommand
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


# The shown value rises only if the estimate exceeds it by this share: relaxation after a load and errors of
# the sag are about as large, and must not make it fluctuate
_HYSTERESIS = 0.05
_MEAN_S = 60.0  # the time left follows the draw of the last minute, not each wave
_IDLE_A = 0.01  # without a draw to speak of the time left is unknown


class FuelGauge:
    """`percent`: shown value, −1 before the first reading; `consumed_mah`: counted charge."""

    def __init__(self) -> None:
        self._counter = ChargeCounter()
        self._sag = SagFilter()
        self._initial_share: float | None = None
        self._shown_share: float | None = None
        self._mean_a: float | None = None
        self._capacity_mah = 0.0
        self._last_s = 0.0

    @property
    def consumed_mah(self) -> float:
        """Charge consumed since boot, or since the pack was changed."""
        return self._counter.consumed_mah

    @property
    def percent(self) -> int:
        """Remaining charge in percent."""
        return -1 if self._shown_share is None else round(100.0 * self._shown_share)

    @property
    def time_left_s(self) -> float | None:
        """Until the pack is empty at the mean current of the last minute; None if not known."""
        if self._shown_share is None or self._mean_a is None or self._mean_a < _IDLE_A:
            return None
        return self._shown_share * self._capacity_mah * 3.6 / self._mean_a

    def update(self, reading: BatteryReading, battery: BatteryPack, command: MotorCommand) -> None:
        """Add a reading. command: motor command at its time."""
        self._counter.add(reading)
        dt_s, self._last_s = max(reading.time_s - self._last_s, 0.0), reading.time_s
        if self._initial_share is None:
            self._initial_share = resting_share(reading.voltage_v / battery.cells)
        self._capacity_mah = battery.capacity_mah
        self._follow_current(reading.current_a, dt_s)
        if reading.current_a is not None:
            share = max(self._initial_share - self.consumed_mah / battery.capacity_mah, 0.0)
        else:
            self._sag.update(reading.voltage_v, _loads(command), dt_s)
            share = resting_share(self._sag.open_circuit_v / battery.cells)
        if self._shown_share is None:
            self._shown_share = share
        else:
            self._shown_share = min(max(self._shown_share, share - _HYSTERESIS), share)

    def _follow_current(self, current_a: float | None, dt_s: float) -> None:
        if current_a is None or self._mean_a is None:
            self._mean_a = current_a
        else:
            self._mean_a += (current_a - self._mean_a) * -math.expm1(-dt_s / _MEAN_S)

    def reset(self, share: float) -> None:
        """Set the state of charge of another or recharged pack."""
        self._counter = ChargeCounter()
        self._sag = SagFilter()
        self._initial_share = self._shown_share = share


def _loads(command: MotorCommand) -> tuple[float, float]:
    """Load of the motors: stalled (linear) or of a free propeller (cubic); real ones are in between."""
    left, right = abs(command.left), abs(command.right)
    return left + right, left**3 + right**3


class SagFilter:
    """Kalman filter of the open-circuit voltage and of the sag per unit of either load, all random walks. The
    measurement is open_circuit_v − Σ load × sag_v.
    """

    _NOISE_V2 = 0.05**2  # of a reading: ripple of the motors, and a monitor's steps of some 10 mV
    # Open-circuit voltage: a pack that is emptied in 25 minutes loses 3 V, 2 mV a second. Sag: the resistance
    # rises as the pack gets cold or empty, over minutes
    _DRIFTS_V2_S = (0.003**2, 0.001**2, 0.001**2)
    _FIRST_SAG_V = 0.15  # 3 A through 50 mΩ, of each kind;
    _FIRST_SAG_V2 = 0.3**2  # twice as uncertain as large

    def __init__(self) -> None:
        self._state: list[float] = []  # none before the first reading
        self._covariance: list[list[float]] = []

    @property
    def open_circuit_v(self) -> float:
        """Voltage of the pack at rest."""
        return self._state[0]

    def update(self, voltage_v: float, loads: tuple[float, float], dt_s: float) -> None:
        """Add a reading, dt_s after the last."""
        row = (1.0, -loads[0], -loads[1])  # H
        if not self._state:
            self._state = [voltage_v + self._FIRST_SAG_V * sum(loads), self._FIRST_SAG_V, self._FIRST_SAG_V]
            firsts = (self._NOISE_V2, self._FIRST_SAG_V2, self._FIRST_SAG_V2)
            self._covariance = [[firsts[i] if i == j else 0.0 for j in range(3)] for i in range(3)]
            return
        covariance = self._covariance
        for i, drift in enumerate(self._DRIFTS_V2_S):
            covariance[i][i] += drift * dt_s
        spread = [sum(one * h for one, h in zip(line, row, strict=True)) for line in covariance]  # P Hᵀ
        variance = sum(h * one for h, one in zip(row, spread, strict=True)) + self._NOISE_V2
        innovation_v = voltage_v - sum(h * one for h, one in zip(row, self._state, strict=True))
        for i in range(3):
            gain = spread[i] / variance
            self._state[i] += gain * innovation_v
            for j in range(3):
                covariance[i][j] -= gain * spread[j]
