"""An emulated boat as a process of its own, for whatever is to be measured from outside."""

import contextlib
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

Process = subprocess.Popen[str]


@contextlib.contextmanager
def served_boat(
    *arguments: str, cwd: Path | None = None, program: Sequence[str] = ()
) -> Iterator[tuple[Process, int]]:
    """`boat-sitl serve open` with these arguments besides: the process, and its TCP port.

    program: what to run instead of boat-sitl.
    """
    command = [
        *(program or [str(Path(sys.executable).with_name("boat-sitl"))]),
        "serve",
        "open",
        "--tcp",
        "0",
        "--no-udp",
        *arguments,
    ]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=cwd)
    try:
        assert process.stdout is not None
        port = int(process.stdout.readline().partition("tcpin:127.0.0.1:")[2].partition(",")[0])
        yield process, port
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(timeout=10)
