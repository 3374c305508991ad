"""`boat-survey export`: the samples of logs as a table."""

import sys
from pathlib import Path
from typing import Annotated

from companion.cli.command_line import Argument, Option, echo
from companion.cli.interrupts import importing
from companion.cli.output_file import output_file
from mission_tools.errors import LogError
from mission_tools.overwrite_guard import check_replaceable

Logs = Annotated[list[Path], Argument(metavar="LOG", help="of the boat's folder logs, such as 00012.bin")]


def export(
    log: Logs,
    out: Annotated[Path | None, Option("--out", "-o", metavar="FILE", help="a .csv [stdout]")] = None,
    force: Annotated[bool, Option(help="replace a file that this program did not write")] = False,
) -> None:
    """Write every sounding and every value of a probe, with time and place, as a table.

    One row a value, in CSV: when it was measured, where its sensor was then, how the boat lay and moved, and
    the value. docs/survey.md explains the columns. Without --out the table goes to stdout. Exit code 2 if a
    file is no log, or none has a sample.

    Example:  boat-survey export 00012.bin 00013.bin --out survey.csv
    """
    with importing():
        from mission_tools.bathymetry.from_log import read_logs  # noqa: PLC0415 - numpy and PROJ
        from mission_tools.bathymetry.sample_table import write_table  # noqa: PLC0415
        from mission_tools.wording import counted  # noqa: PLC0415

    if out is not None:
        check_replaceable("--out", out, force=force)
    logs = read_logs(log)
    for note in (note for one in logs for note in one.notes):
        echo(f"note: {note}", is_error=True)
    if not any(len(one.sounded_s) + len(one.values) for one in logs):
        raise LogError(
            f"{counted(len(logs), 'log')} without samples: nothing to write: fit a sounder or a probe"
        )
    if out is None:
        write_table(logs, sys.stdout)
        return
    with output_file(out) as aside, aside.open("w", encoding="utf-8", newline="") as file:
        count = write_table(logs, file)
    echo(f"{counted(count, 'sample')} of {counted(len(logs), 'log')} saved in {out}")
