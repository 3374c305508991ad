"""Run every benchmark: prints a table, writes docs/benchmarks.md and out/benchmarks.json."""

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

PAGE = Path("docs/benchmarks.md")
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

Compare this project with pymavlink and MAVProxy on your machine:

    make bench

It rewrites this page. Each section is one file in `benchmarks/` or its folder `planning/`. This project and
the peer run alternately in one process. Figures are medians ± half the interquartile range; the ratio is the
median of the pairs. Times are CPU time, except wall-clock time for transfers and garbage. On a shared machine
the ratios are more reliable than the times.

`python -m benchmarks.estimation` judges the filter; its figures are in [estimation](estimation.md).

Machine: {machine}. Measured on {day}.
"""


def main(names: list[str]) -> int:
    """Run the named benchmarks, all without a name. A full run rewrites the page, another its sections."""
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
    PAGE.write_text(_page(found) if not names else _with_sections(found), encoding="utf-8")
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


def _section(name: str, rows: list[Row], note: str = "") -> str:
    lines = [f"## {name}", "", *((note, "") if note else ())]
    lines += ["| question | ours | peer | ours ÷ peer |", "|---|---|---|---|"]
    lines += [f"| {' | '.join(_cells(row))} |" for row in rows]
    return "\n".join(lines) + "\n"


def _with_sections(found: dict[str, list[Row]]) -> str:
    """The page as it is, with these sections in place of theirs, in the order of the benchmarks."""
    introduction, *sections = PAGE.read_text(encoding="utf-8").split("\n## ")
    by_name = {section.split("\n", 1)[0]: f"## {section.rstrip()}\n" for section in sections}
    day = time.strftime("%d %B %Y")
    for name, rows in found.items():
        note = f"Measured on {day}, with `python -m benchmarks {name}`."
        by_name[name] = _section(name, rows, note)
    order = [*BENCHMARKS, *(name for name in by_name if name not in BENCHMARKS)]
    return "\n".join([introduction.rstrip() + "\n", *(by_name[name] for name in order if name in by_name)])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
