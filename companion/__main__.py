"""boat-companion: the program on the boat."""

import sys

from companion.cli.interrupts import Run, run_interruptibly


def load() -> Run:
    """Do the imports, which take a second; returns the program."""
    from companion.app.cli import run_program  # noqa: PLC0415 (an interrupt meanwhile ends without a traceback)

    return run_program


def main() -> None:
    """Entry point."""
    sys.exit(run_interruptibly("boat-companion", load))


if __name__ == "__main__":
    main()
