"""How every benchmark measures: ours and the peer in turn, in one process; median, spread and ratio."""

import gc
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class Row:
    """One figure. better is "less" or "more"; ratio is ours ÷ peer's, the median over the paired rounds."""

    question: str
    unit: str
    better: str
    ours: float
    spread: float  # half the distance between the quartiles
    peer_name: str = ""
    peer: float | None = None
    ratio: float | None = None
    note: str = ""

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)


def cpu_seconds(work: Callable[[], object]) -> float:
    """CPU time of one call, without the garbage collector's whims."""
    gc.collect()
    gc.disable()
    try:
        began = time.process_time()
        work()
        return time.process_time() - began
    finally:
        gc.enable()


def paired(
    question: str,
    unit: str,
    scale: float,
    ours: Callable[[], object],
    peer_name: str,
    peer: Callable[[], object],
    rounds: int = 9,
) -> Row:
    """CPU time of both in turn, A B A B …, after one round that is not counted. Less is better."""
    ours()
    peer()
    pairs = [(cpu_seconds(ours) * scale, cpu_seconds(peer) * scale) for _ in range(rounds)]
    mine, theirs = zip(*pairs, strict=True)
    return Row(
        question,
        unit,
        "less",
        statistics.median(mine),
        spread(mine),
        peer_name,
        statistics.median(theirs),
        statistics.median(a / b for a, b in pairs),
    )


def alone(question: str, unit: str, better: str, values: Sequence[float], note: str = "") -> Row:
    """A figure that has no peer here."""
    return Row(question, unit, better, statistics.median(values), spread(values), note=note)


def spread(values: Sequence[float]) -> float:
    """Half the distance between the quartiles; 0 for a single value."""
    if len(values) < 2:
        return 0.0
    low, _, high = statistics.quantiles(values, n=4)
    return 0.5 * (high - low)
