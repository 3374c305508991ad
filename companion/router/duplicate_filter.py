"""Detects frames received again on another link: two radios to one station, or a network loop."""

WINDOW_S = 0.5
MAX_FRAMES = 4096


class DuplicateFilter:
    """Remembers frames for half to one window, less during a flood.

    Repeats on the same link are not duplicates.
    """

    def __init__(self, window_s: float = WINDOW_S, max_frames: int = MAX_FRAMES) -> None:
        self._half_s = 0.5 * window_s
        self._half_frames = max_frames // 2
        self._recent: dict[bytes, int] = {}
        self._older: dict[bytes, int] = {}
        self._turn_s = 0.0

    def is_duplicate(self, data: bytes, channel: int, now_s: float) -> bool:
        """Whether another channel has brought this frame within the window; otherwise it is remembered."""
        recent = self._recent
        if now_s >= self._turn_s or len(recent) >= self._half_frames:
            self._turn(now_s)
            recent = self._recent
        first = recent.get(data)
        if first is None:
            first = self._older.get(data)
            if first is None or first == channel:
                recent[data] = channel
                return False
        return first != channel

    def _turn(self, now_s: float) -> None:
        # after a long silence both halves are outdated
        is_overdue = now_s >= self._turn_s + self._half_s
        self._older = {} if is_overdue else self._recent
        self._recent = {}
        # from the due time, so that a late turn does not extend the window
        is_due = now_s >= self._turn_s and not is_overdue
        self._turn_s = (self._turn_s if is_due else now_s) + self._half_s
