"""Run every benchmark: prints a table, writes out/benchmarks.md and out/benchmarks.json.

docs/benchmarks.md tells what these figures say.
"""

import json
import os
import platform
import sys
import time
from collections.abc import Callable
from pathlib import Path

from rich.console import Console
from rich.table import Table

from benchmarks import codec, emulator, install, router, transfer
from benchmarks.measure import Row
from benchmarks.planning import peers, routes, startup, survey, watch

PAGE = Path("out/benchmarks.md")
JSON = Path("out/benchmarks.json")
BENCHMARKS: dict[str, Callable[[], list[Row]]] = {
    "codec": codec.rows,
    "peers": peers.rows,
    "emulator": emulator.rows,
    "transfer": transfer.rows,
    "router": router.rows,
    "routes": routes.rows,
    "startup": startup.rows,
    "survey": survey.rows,
    "watch": watch.rows,
    "install": install.rows,
}

_INTRODUCTION = """# Benchmarks

Machine: {machine}. Measured on {day}: median ± half the interquartile range.
"""


def main(names: list[str]) -> int:
    """Run the named benchmarks, all without a name."""
    unknown = [name for name in names if name not in BENCHMARKS]
    if unknown:
        sys.stderr.write(f"benchmarks: no {', '.join(unknown)}; there are {', '.join(BENCHMARKS)}\n")
        return 2
    found: dict[str, list[Row]] = {}
    for name in names or BENCHMARKS:
        found[name] = BENCHMARKS[name]()
        _print(name, found[name])
    JSON.parent.mkdir(exist_ok=True)
    JSON.write_text(
        json.dumps({name: [row.as_dict() for row in rows] for name, rows in found.items()}, indent=2)
    )
    PAGE.write_text(_page(found), encoding="utf-8")
    return 0


def _cells(row: Row) -> tuple[str, str, str, str]:
    peer = row.note or "–" if row.peer is None else f"{row.peer_name}: {row.peer:.3g} {row.unit}"
    ratio = "–" if row.ratio is None else f"{row.ratio:.2f}" if row.ratio > 0.1 else f"{row.ratio:.2g}"
    return row.question, f"{row.ours:.3g} ± {row.spread:.2g} {row.unit}", peer, ratio


def _print(name: str, rows: list[Row]) -> None:
    table = Table("question", "ours", "peer", "ours ÷ peer", title=name)
    for row in rows:
        table.add_row(*_cells(row))
    Console().print(table)


def _page(found: dict[str, list[Row]]) -> str:
    cores = len(os.sched_getaffinity(0))
    machine = f"{platform.machine()}, {cores} cores, {platform.system()}, Python {platform.python_version()}"
    introduction = _INTRODUCTION.format(machine=machine, day=time.strftime("%d %B %Y"))
    return "\n".join([introduction, *(_section(name, rows) for name, rows in found.items())])


def _section(name: str, rows: list[Row]) -> str:
    lines = [f"## {name}", "", "| question | ours | peer | ours ÷ peer |", "|---|---|---|---|"]
    lines += [f"| {' | '.join(_cells(row))} |" for row in rows]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
