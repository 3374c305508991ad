"""`mission-download`: save what is on board."""

import sys

from companion.cli.interrupts import Run, run_interruptibly


def load() -> Run:
    """Import the program, which takes a second; returns it."""
    from mission_tools.cli.download_command import run_program as run  # noqa: PLC0415 (may be interrupted)

    return run


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return load()(arguments)


def main() -> None:
    """Run mission-download and end the process with its exit code."""
    sys.exit(run_interruptibly("mission-download", load))


if __name__ == "__main__":
    main()
