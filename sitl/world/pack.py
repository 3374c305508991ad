"""A pack of lithium-polymer cells: open-circuit voltage over the charge left, less the resistance's drop.

The resistance rises as the last fifth is drawn, and below empty the voltage falls off a cliff, as a pack's
does whose cells are drained too deep: so a boat that sails on loses first its speed, then its computer.
"""

import math
from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share

# Open-circuit voltage of one cell at 0, 10 … 100 % charge: the shape common to LiPo cells at rest, flat in
# the middle and steep at the empty end.
CELL_V = (3.27, 3.61, 3.69, 3.73, 3.77, 3.80, 3.84, 3.90, 3.98, 4.08, 4.20)
CLIFF = 0.03  # share of the capacity that can be drawn below empty, until nothing is left
_LAST = 0.2  # share of the charge over which the resistance rises
# A blade fuse opens after 0.75 to 600 s at 1.35 times its rating, 0.15 to 5 s at twice and 0.08 to 0.5 s at
# 3.5 times (ISO 8820-3). Its wire melts once the heat beyond what it gives off, ∫ (I²/I_r² − 1) dt, is this:
# after 3.6 s, 1 s and 0.27 s.
_MELTS_S = 3.0
_RISE = 2.0  # how much more of it there is when empty, of what there is when full


class BatterySettings(Section, frozen=True):
    """One pack. charge is the share left at the start; idle_a is what computer and sensors draw.

    brownout_v is the voltage at the terminals below which the computer's regulator gives up: five volts,
    the two that a plain one drops, and some for the leads. fuse_a: rating of the fuse beside the pack, 0
    without one.
    """

    capacity_mah: Positive = 2200.0
    cells: Annotated[int, Meta(ge=1, le=10)] = 3
    resistance_ohm: NonNegative = 0.05
    charge: Share = 1.0
    idle_a: NonNegative = 0.6
    brownout_v: NonNegative = 7.0
    rate_hz: Positive = 10.0
    fuse_a: NonNegative = 0.0


class Pack:
    """The pack's state: the charge taken out, and voltage and current at its terminals."""

    def __init__(self, parameters: BatterySettings) -> None:
        """Start with the given charge, loaded by the electronics."""
        self._parameters = parameters
        self._capacity_c = parameters.capacity_mah * 3.6
        self._used_c = (1.0 - parameters.charge) * self._capacity_c
        self.current_a = self.voltage_v = 0.0
        self._fuse_heat_s = 0.0
        self.step(0.0, 0.0)
        self.supply_v = self.voltage_v

    @property
    def charge(self) -> float:
        """Share of the capacity left, 0..1."""
        return max(0.0, 1.0 - self._used_c / self._capacity_c)

    @property
    def used_mah(self) -> float:
        """Charge taken out since full."""
        return self._used_c / 3.6

    def step(self, motor_current_a: float, dt_s: float) -> None:
        """Draw the motors' current and the electronics' for dt_s.

        supply_v is the voltage that the motors see in the next step: the mean of the last two, since the
        current that sags it is drawn with it, and even a worn-out pack's voltage must not swing from step
        to step.
        """
        parameters = self._parameters
        self.current_a = current_a = motor_current_a + parameters.idle_a
        self._used_c += current_a * dt_s
        charge = 1.0 - self._used_c / self._capacity_c
        resistance_ohm = parameters.resistance_ohm
        if charge >= _LAST:
            tenths = 10.0 * charge
            below = int(tenths) if tenths < 10.0 else 9  # a full cell lies at the end of the last piece
            cell_v = CELL_V[below] + (tenths - below) * (CELL_V[below + 1] - CELL_V[below])
        elif charge > 0.0:
            tenths = 10.0 * charge
            below = int(tenths)
            cell_v = CELL_V[below] + (tenths - below) * (CELL_V[below + 1] - CELL_V[below])
            resistance_ohm *= 1.0 + _RISE * (_LAST - charge) / _LAST
        else:
            self._used_c = min(self._used_c, (1.0 + CLIFF) * self._capacity_c)
            cell_v = max(0.0, CELL_V[0] * (1.0 + charge / CLIFF))
            resistance_ohm *= 1.0 + _RISE
        if parameters.fuse_a > 0.0:
            loaded = current_a / parameters.fuse_a
            self._fuse_heat_s = max(self._fuse_heat_s + (loaded * loaded - 1.0) * dt_s, 0.0)
            if self._fuse_heat_s >= _MELTS_S:
                self._fuse_heat_s = math.inf
                self.current_a = cell_v = 0.0
        voltage_v = max(0.0, parameters.cells * cell_v - current_a * resistance_ohm)
        self.supply_v = 0.5 * (self.voltage_v + voltage_v)
        self.voltage_v = voltage_v
