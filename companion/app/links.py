"""`boat-companion links`: the links of the running boat."""

import contextlib
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import msgspec
from rich.console import Console
from rich.live import Live
from rich.markup import escape
from rich.table import Table

from companion.app.status_file import BoatStatus, find_status, read_status
from companion.cli.command_line import ConfigFile, Option, echo
from companion.config.boat_config import load_config

_REFRESH_S = 1.0
_COLUMNS = ("link", "heard", "in/s", "out/s", "frames in", "out", "forwarded", "lost", "bad", "dropped")


def links(
    config: ConfigFile,
    as_json: Annotated[bool, Option("--json", help="Print the figures once, as JSON.")] = False,
) -> None:
    """Show the running boat's links, second by second, until Ctrl-C.

    Example:  boat-companion links --config /etc/mavboat/boat.toml
    """
    path = find_status(load_config(config))
    if as_json:
        echo(msgspec.json.format(msgspec.json.encode(read_status(path))).decode())
        return
    with contextlib.suppress(KeyboardInterrupt):
        watch(path, Console())


def draw(status: BoatStatus) -> Table:
    links = status.links
    late = f"{status.late_ticks} of {status.ticks} ticks late, worst {1e3 * status.worst_late_s:.1f} ms"
    routed = f"{links.repeats} repeats, {links.unreachable} for nobody, {links.reboots} reboots"
    missing = "".join(f"\n{name}: {fault}" for name, fault in status.missing.items())
    table = Table(title=f"load {status.load:.0%}; {late}", caption=escape(routed + missing))
    for name in _COLUMNS:
        table.add_column(name, justify="left" if name in _COLUMNS[:2] else "right")
    for link in links.links:
        rates = (f"{link.in_bytes_s:.0f} B", f"{link.out_bytes_s:.0f} B")
        counts = (link.frames_in, link.frames_out, link.forwarded, link.lost, link.bad, link.dropped)
        table.add_row(link.name, " ".join(link.heard), *rates, *(str(count) for count in counts))
    return table


def watch(path: Path, console: Console, pause: Callable[[float], None] = time.sleep) -> None:
    """Draw the links again and again, until interrupted. StorageError: the boat does not run."""
    with Live(draw(read_status(path)), console=console, auto_refresh=False) as live:
        while True:
            pause(_REFRESH_S)
            live.update(draw(read_status(path)), refresh=True)
