"""The date: satellites tell it; until they do, a station's goes before the computer's own."""

from companion.sensors.readings import GnssFix

_FIX_2D = 2  # below it there is no fix, and the receiver's clock may hold anything


class WallTime:
    """offset_s: what to add to the boat's time for seconds since 1970; 0 while nobody has told the date."""

    __slots__ = ("_dated", "_is_by_satellites", "_own_offset_s", "offset_s")

    def __init__(self, offset_s: float = 0.0) -> None:
        """offset_s: by the computer's own date, 0 while that is plainly unset."""
        self.offset_s = offset_s
        self._own_offset_s = offset_s  # by satellites or the computer, never by a station's word
        self._is_by_satellites = False
        self._dated: GnssFix | None = None

    def update(self, fix: GnssFix | None, told_offset_s: float | None, *, is_fix_own: bool = True) -> None:
        """To be called every tick. told_offset_s: as a station has it, None while none has said. is_fix_own:
        not one that came over MAVLink.
        """
        if fix is self._dated and self._is_by_satellites:
            return
        self._dated = fix
        if fix is not None and fix.fix_type >= _FIX_2D and fix.unix_time_s is not None:
            self.offset_s, self._is_by_satellites = fix.unix_time_s - fix.time_s, True
            if is_fix_own:
                self._own_offset_s = self.offset_s
        elif told_offset_s is not None and not self._is_by_satellites:
            self.offset_s = told_offset_s

    def unix_s(self, now_s: float) -> float:
        """The date at a time since boot, 0 while it is not known."""
        return now_s + self.offset_s if self.offset_s else 0.0

    def own_unix_s(self, now_s: float) -> float:
        """The date that signatures rest on: never a station's, which nobody has to sign; 0 while not
        known.
        """
        return now_s + self._own_offset_s if self._own_offset_s else 0.0
