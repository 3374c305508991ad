"""The committed corpus: one text file a target, one input a line, in base64."""

import base64
from collections.abc import Iterable
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "vectors" / "fuzz"
MOST_BYTES = 100_000  # a target's share of the committed megabyte


def load(target: str) -> list[bytes]:
    """The inputs of a target."""
    path = FOLDER / f"{target}.txt"
    if not path.exists():
        return []
    return [base64.b64decode(line) for line in path.read_text(encoding="ascii").split()]


def save(target: str, inputs: Iterable[bytes]) -> None:
    """Keep inputs, shortest first, as far as there is room."""
    lines, room = [], MOST_BYTES
    for one in sorted(set(inputs), key=lambda data: (len(data), data)):
        line = base64.b64encode(one).decode("ascii")
        room -= len(line) + 1
        if room < 0:
            break
        if line:
            lines.append(line)
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / f"{target}.txt").write_text("\n".join(lines) + "\n", encoding="ascii")
