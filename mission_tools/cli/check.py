"""`mission-check`: problems in a mission file."""

import sys

from companion.cli.interrupts import Run, run_interruptibly


def load() -> Run:
    """Do the imports, which take a second; returns the program."""
    from mission_tools.cli.check_command import run_program as run  # noqa: PLC0415 (may be interrupted)

    return run


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return load()(arguments)


def main() -> None:
    """Run mission-check and end the process with its exit code."""
    sys.exit(run_interruptibly("mission-check", load))


if __name__ == "__main__":
    main()
