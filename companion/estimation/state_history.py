"""Recent motion through the water, to apply a fix at the time of its measurement."""

from typing import Final

LENGTH: Final = 128  # ticks, two and a half seconds


class StateHistory:
    """A ring of the last LENGTH ticks.

    displacement_m: through the water since boot; velocity_m_s: through the water; both north + i east.
    """

    def __init__(self) -> None:
        self._times_s = [-1.0] * LENGTH
        self._displacements = [0j] * LENGTH
        self._velocities = [0j] * LENGTH
        self._next = 0
        self.time_s = 0.0
        self.displacement_m = 0j
        self.velocity_m_s = 0j

    def advance(self, time_s: float, velocity_m_s: complex) -> None:
        """Add a tick, later than the last."""
        self.displacement_m += velocity_m_s * (time_s - self.time_s)
        self.time_s = time_s
        self.velocity_m_s = velocity_m_s
        slot = self._next
        self._times_s[slot], self._displacements[slot], self._velocities[slot] = (
            time_s,
            self.displacement_m,
            velocity_m_s,
        )
        self._next = slot + 1 if slot + 1 < LENGTH else 0

    def at(self, time_s: float) -> tuple[complex, complex]:
        """Displacement and velocity at an earlier time; before the start of the ring, its oldest entry."""
        times_s, slot = self._times_s, self._next
        for _ in range(LENGTH):
            before = slot - 1 if slot else LENGTH - 1
            if times_s[before] < 0.0:
                break
            slot = before
            if times_s[slot] <= time_s:
                velocity = self._velocities[slot]
                return self._displacements[slot] + velocity * (time_s - times_s[slot]), velocity
        if slot == self._next:
            return self.displacement_m, self.velocity_m_s
        return self._displacements[slot], self._velocities[slot]
