"""`mission-trace`: turn an aerial photograph into a map of its water."""

import sys

from companion.cli.interrupts import Run, run_interruptibly


def load() -> Run:
    """Do the imports; returns the program."""
    from mission_tools.cli.trace_command import run_program as run  # noqa: PLC0415 (may be interrupted)

    return run


def main() -> None:
    """Run mission-trace and end the process with its exit code."""
    sys.exit(run_interruptibly("mission-trace", load))


if __name__ == "__main__":
    main()
