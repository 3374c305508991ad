"""Frames that come a second time by another link: two radios to one station, or a loop in the network."""

WINDOW_S = 0.5
MAX_FRAMES = 4096


class DuplicateFilter:
    """Remembers frames for half a window to a whole one, and fewer seconds in a flood.

    A link may say the same twice, which it does when it is asked twice; only what another link has said
    first is a repeat.
    """

    def __init__(self, window_s: float = WINDOW_S, max_frames: int = MAX_FRAMES) -> None:
        self._half_s = 0.5 * window_s
        self._half_frames = max_frames // 2
        self._recent: dict[bytes, int] = {}
        self._older: dict[bytes, int] = {}
        self._turn_s = 0.0

    def is_duplicate(self, data: bytes, channel: int, now_s: float) -> bool:
        """Whether another channel has brought this very frame within the window; if not, it is remembered."""
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
        # after a long silence what was recent is old news as well
        is_overdue = now_s >= self._turn_s + self._half_s
        self._older = {} if is_overdue else self._recent
        self._recent = {}
        # counted from when the turn was due, so that a turn that comes late makes no memory longer
        is_due = now_s >= self._turn_s and not is_overdue
        self._turn_s = (self._turn_s if is_due else now_s) + self._half_s
