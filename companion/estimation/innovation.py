"""What a measurement said against its prediction."""

from typing import Final

from msgspec import Struct

# χ² gate of two degrees of freedom at 5 standard deviations: rejects one good measurement in 10⁶
GATE_2: Final = 50.0
DISAGREES_S: Final = 0.6  # for which the gate must reject a sensor until it is called wrong: three fixes


class Innovation(Struct, gc=False):
    """The innovation of a scalar measurement, its predicted variance, and the gate's decision.

    count: of all so far, and the sum of their nis, this one included.
    """

    time_s: float
    value: float
    variance: float
    is_accepted: bool = False
    count: int = 0
    nis_sum: float = 0.0

    @property
    def nis(self) -> float:
        """Normalised innovation squared."""
        return self.value * self.value / self.variance

    def next(self, time_s: float, value: float, variance: float) -> "Innovation":
        """The one that follows."""
        nis_sum = self.nis_sum + value * value / variance
        return Innovation(time_s, value, variance, count=self.count + 1, nis_sum=nis_sum)


def square(vector: complex) -> float:
    """Squared length of a vector, north + i east."""
    return vector.real * vector.real + vector.imag * vector.imag


NO_INNOVATION: Final = Innovation(-1.0, 0.0, 1.0)
