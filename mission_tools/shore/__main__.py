"""boat-shore: the page's program."""

import sys

from companion.cli.interrupts import Run, run_interruptibly


def load() -> Run:
    """Do the imports, which take a second; returns the program."""
    from mission_tools.shore.program import run_program  # noqa: PLC0415 (an interrupt ends without a traceback)

    return run_program


def main() -> None:
    """Run boat-shore as a program."""
    sys.exit(run_interruptibly("boat-shore", load))


if __name__ == "__main__":
    main()
