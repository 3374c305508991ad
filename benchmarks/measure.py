"""How every benchmark measures, ours and the peer in turn in one process, and the tables that it writes."""

import gc
import statistics
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path("out")


@dataclass(frozen=True)
class Row:
    """One figure. spread: half the distance between the quartiles; ratio: ours ÷ peer's."""

    question: str
    unit: str
    ours: float
    spread: float = 0.0
    peer_name: str = ""
    peer: float | None = None
    ratio: float | None = None
    note: str = ""


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
    """CPU time of both in turn, A B A B …, after one round that is not counted."""
    ours()
    peer()
    return of_pairs(
        question,
        unit,
        [(cpu_seconds(ours) * scale, cpu_seconds(peer) * scale) for _ in range(rounds)],
        peer_name,
    )


def of_pairs(
    question: str, unit: str, pairs: Sequence[tuple[float, float]], peer_name: str, note: str = ""
) -> Row:
    """A figure beside its peer's. pairs: (ours, peer's) of each round."""
    ours, theirs = zip(*pairs, strict=True)
    ratio = statistics.median(a / b for a, b in pairs) if all(theirs) else None
    middle = statistics.median
    return Row(question, unit, middle(ours), _spread(ours), peer_name, middle(theirs), ratio, note)


def alone(question: str, unit: str, values: Sequence[float], note: str = "") -> Row:
    """A figure that has no peer here."""
    return Row(question, unit, statistics.median(values), _spread(values), note=note)


def _spread(values: Sequence[float]) -> float:
    """Half the distance between the quartiles; 0 for a single value."""
    if len(values) < 2:
        return 0.0
    low, _, high = statistics.quantiles(values, n=4)
    return 0.5 * (high - low)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def write(name: str, text: str) -> None:
    FOLDER.mkdir(exist_ok=True)
    (FOLDER / f"{name}.md").write_text(text, encoding="utf-8")
