"""How well the loop keeps time."""

from dataclasses import dataclass


@dataclass(slots=True)
class TickCount:
    """How well the loop has kept time."""

    run: int = 0
    late: int = 0  # started more than LATE_S after their time
    skipped: int = 0
    worst_s: float = 0.0
