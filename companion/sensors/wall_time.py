"""Date and time: from GNSS, else from a station, else from the computer."""

from companion.core.readings import GnssFix

_FIX_2D = 2  # without a fix the receiver's clock is unreliable


class WallTime:
    """offset_s: Unix time less the boat's time; 0 if unknown."""

    def __init__(self, offset_s: float = 0.0) -> None:
        """offset_s: by the computer's clock, 0 if that is not set."""
        self.offset_s = offset_s
        self._own_offset_s = offset_s  # from GNSS or the computer, never from a station
        self._is_by_satellites = False
        self._dated: GnssFix | None = None

    def update(self, fix: GnssFix | None, station_offset_s: float | None, *, is_fix_own: bool = True) -> None:
        """Call every tick. station_offset_s: None if unknown. is_fix_own: not from MAVLink."""
        if fix is self._dated and self._is_by_satellites:
            return
        self._dated = fix
        if fix is not None and fix.fix_type >= _FIX_2D and fix.unix_time_s is not None:
            self.offset_s, self._is_by_satellites = fix.unix_time_s - fix.time_s, True
            if is_fix_own:
                self._own_offset_s = self.offset_s
        elif station_offset_s is not None and not self._is_by_satellites:
            self.offset_s = station_offset_s

    def unix_s(self, now_s: float) -> float:
        """Unix time at a time since boot, 0 if unknown."""
        return now_s + self.offset_s if self.offset_s else 0.0

    def own_unix_s(self, now_s: float) -> float:
        """Unix time for signatures: never from a station, whose messages may be unsigned; 0 if unknown."""
        return now_s + self._own_offset_s if self._own_offset_s else 0.0
