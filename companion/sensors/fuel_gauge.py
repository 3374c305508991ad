"""How much charge the pack has left, as an operator should see it.

With a monitor that measures current, charge is counted down from what the voltage said at the first reading,
before the motors turn. Without current, the open-circuit voltage is estimated: terminal voltage is that less
sag, and sag is what the motors are given times learned factors. A Kalman filter learns both from how the
voltage answers the motors; Plett, "Battery Management Systems, Volume II", 2015, chapter 3, has such a
model with a measured current.
"""

from companion.config.boat_config import BatteryPack
from companion.core.state import MotorCommand
from companion.sensors.charge import ChargeCounter, resting_share
from companion.sensors.readings import BatteryReading

# What is shown rises only once the estimate is higher by more than this share: relaxation of the pack after a
# load, and errors of the sag, come to about as much, and must not make the figure go up and down
_HYSTERESIS = 0.05


class FuelGauge:
    """`percent` is what to show, −1 before the first reading; `consumed_mah` what has been counted."""

    __slots__ = ("_begun_share", "_counter", "_last_s", "_sag", "_shown_share")

    def __init__(self) -> None:
        self._counter = ChargeCounter()
        self._sag = SagFilter()
        self._begun_share: float | None = None
        self._shown_share: float | None = None
        self._last_s = 0.0

    @property
    def consumed_mah(self) -> float:
        """Charge taken from the pack since boot, or since it was changed."""
        return self._counter.consumed_mah

    @property
    def percent(self) -> int:
        """Charge left, in whole percent."""
        return -1 if self._shown_share is None else round(100.0 * self._shown_share)

    def update(self, reading: BatteryReading, battery: BatteryPack, command: MotorCommand) -> None:
        """Take a new reading. command: what the motors were given when it was taken."""
        self._counter.add(reading)
        dt_s, self._last_s = max(reading.time_s - self._last_s, 0.0), reading.time_s
        if self._begun_share is None:
            self._begun_share = resting_share(reading.voltage_v / battery.cells)
        if reading.current_a is not None:
            share = max(self._begun_share - self.consumed_mah / battery.capacity_mah, 0.0)
        else:
            self._sag.update(reading.voltage_v, _loads(command), dt_s)
            share = resting_share(self._sag.open_circuit_v / battery.cells)
        if self._shown_share is None:
            self._shown_share = share
        else:
            self._shown_share = min(max(self._shown_share, share - _HYSTERESIS), share)

    def reset(self, share: float) -> None:
        """Another pack, or this one charged: it has this share of its charge now."""
        self._counter = ChargeCounter()
        self._sag = SagFilter()
        self._begun_share = self._shown_share = share


def _loads(command: MotorCommand) -> tuple[float, float]:
    """What the motors are given, as a stalled motor draws it (linear) and as a free propeller does (cubic):
    a real one is in between."""
    left, right = abs(command.left), abs(command.right)
    return left + right, left**3 + right**3


class SagFilter:
    """Open-circuit voltage, and the volts of sag for a load of 1 of each kind: a Kalman filter whose states
    wander slowly. The measurement is open_circuit_v − Σ load × sag_v."""

    __slots__ = ("_covariance", "_state")

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
        """What the pack's voltage would be at rest."""
        return self._state[0]

    def update(self, voltage_v: float, loads: tuple[float, float], dt_s: float) -> None:
        """Take a reading, dt_s after the last."""
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
