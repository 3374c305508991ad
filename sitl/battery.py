"""A pack of lithium-polymer cells: open-circuit voltage over the charge left, less the resistance's drop."""

from typing import Annotated

from msgspec import Meta

from companion.section import NonNegative, Positive, Section, Share

# Open-circuit voltage of one cell at 0, 10 … 100 % charge: the shape common to LiPo cells at rest, flat in
# the middle and steep at the empty end.
CELL_V = (3.27, 3.61, 3.69, 3.73, 3.77, 3.80, 3.84, 3.90, 3.98, 4.08, 4.20)


class BatteryParameters(Section, frozen=True):
    """One pack. charge is the share left at the start; idle_a is what computer and sensors draw."""

    capacity_mah: Positive = 2200.0
    cells: Annotated[int, Meta(ge=1, le=10)] = 3
    resistance_ohm: NonNegative = 0.05
    charge: Share = 1.0
    idle_a: NonNegative = 0.6
    rate_hz: Positive = 10.0


class Pack:
    """The pack's state: the charge taken out, and voltage and current at its terminals."""

    __slots__ = ("_capacity_c", "_parameters", "_used_c", "current_a", "voltage_v")

    def __init__(self, parameters: BatteryParameters) -> None:
        """Start with the given charge, loaded by the electronics."""
        self._parameters = parameters
        self._capacity_c = parameters.capacity_mah * 3.6
        self._used_c = (1.0 - parameters.charge) * self._capacity_c
        self.current_a = self.voltage_v = 0.0
        self.step(0.0, 0.0)

    @property
    def charge(self) -> float:
        """Share of the capacity left, 0..1."""
        return max(0.0, 1.0 - self._used_c / self._capacity_c)

    @property
    def used_mah(self) -> float:
        """Charge taken out since full."""
        return self._used_c / 3.6

    def step(self, motor_current_a: float, dt_s: float) -> None:
        """Draw the motors' current and the electronics' for dt_s."""
        parameters = self._parameters
        self.current_a = motor_current_a + parameters.idle_a
        self._used_c += self.current_a * dt_s
        self._used_c = min(self._used_c, self._capacity_c)
        tenths = 10.0 * (1.0 - self._used_c / self._capacity_c)
        below = int(tenths) if tenths < 10.0 else 9  # a full cell lies at the end of the last piece
        cell_v = CELL_V[below] + (tenths - below) * (CELL_V[below + 1] - CELL_V[below])
        self.voltage_v = parameters.cells * cell_v - self.current_a * parameters.resistance_ohm
