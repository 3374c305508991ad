"""Run every benchmark, or those that are named: prints a table of each, and writes out/benchmarks.md.

docs/benchmarks.md tells what these figures say.
"""

import os
import platform
import sys
import time
from collections.abc import Callable, Sequence

from rich.console import Console
from rich.table import Table

from benchmarks import codec, emulator, router
from benchmarks.measure import Row, table, write
from benchmarks.planning import peers, routes, startup, survey, watch

BENCHMARKS: dict[str, Callable[[], list[Row]]] = {
    "codec": codec.rows,
    "router": router.rows,
    "routes": routes.rows,
    "peers": peers.rows,
    "survey": survey.rows,
    "watch": watch.rows,
    "startup": startup.rows,
    "emulator": emulator.rows,
}
HEAD = ("question", "ours", "peer", "ours ÷ peer")


def main(names: list[str]) -> int:
    """Run the named benchmarks, all without a name."""
    unknown = [name for name in names if name not in BENCHMARKS]
    if unknown:
        sys.stderr.write(f"benchmarks: no {', '.join(unknown)}; there are {', '.join(BENCHMARKS)}\n")
        return 2
    page = f"# Benchmarks\n\n{_machine()}\n"
    for name in names or BENCHMARKS:
        rows = [_cells(row) for row in BENCHMARKS[name]()]
        shown = Table(*HEAD, title=name)
        for row in rows:
            shown.add_row(*row)
        Console().print(shown)
        page += f"\n## {name}\n\n{table(HEAD, rows)}"
        write("benchmarks", page)
    return 0


def _cells(row: Row) -> Sequence[str]:
    peer = row.note or "–"
    if row.peer is not None:
        peer = f"{row.peer_name}: {row.peer:.3g} {row.unit}" + (f", {row.note}" if row.note else "")
    ratio = "–" if row.ratio is None else f"{row.ratio:.2f}" if row.ratio > 0.1 else f"{row.ratio:.2g}"
    spread = f" ± {row.spread:.2g}" if row.spread else ""
    return row.question, f"{row.ours:.4g}{spread} {row.unit}".rstrip(), peer, ratio


def _machine() -> str:
    cores = len(os.sched_getaffinity(0))
    day = f"{time.localtime().tm_mday} {time.strftime('%B %Y')}"
    system = f"{platform.machine()}, {cores} cores, {platform.system()}"
    return f"{day}: {system}, Python {platform.python_version()}."


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
