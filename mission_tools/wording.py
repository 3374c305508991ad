"""Lines for people: where they go, and times and lengths as people say them."""

from typing import TextIO


class Printer:
    """Prints lines to a stream, each at once."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def __call__(self, line: str) -> None:
        self.stream.write(line + "\n")
        self.stream.flush()


def counted(count: int, what: str) -> str:
    """no items, 1 item, 2 items."""
    return f"{count or 'no'} {what}{'' if count == 1 else 's'}"


def duration(seconds: float) -> str:
    """41 s, 3 min 20 s, 2 h 05 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"


def distance(metres: float) -> str:
    """0.85 m, 12.3 m, 640 m, 12.35 km."""
    if metres < 10.0:
        return f"{metres:.2f} m"
    if metres < 100.0:
        return f"{metres:.1f} m"
    return f"{metres:.0f} m" if metres < 10_000.0 else f"{metres / 1000.0:.2f} km"
