"""Counts the charge that has left the pack."""

from companion.sensors.readings import BatteryReading

_MAX_GAP_S = 2.0  # a monitor that was silent for longer says nothing about the time between


class ChargeCounter:
    """Integrates the battery current by the trapezoidal rule."""

    __slots__ = ("_last", "consumed_mah")

    def __init__(self) -> None:
        self.consumed_mah = 0.0
        self._last: BatteryReading | None = None

    def add(self, reading: BatteryReading | None) -> None:
        """Take a reading; the same one again adds nothing."""
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
