"""boat-sitl: the emulator's program."""

import sys

from companion.cli.interrupts import Run, run_interruptibly


def load() -> Run:
    """Do the imports, which take seconds; returns the program."""
    from sitl.cli.program import run_program as run  # noqa: PLC0415 (an interrupt ends without a traceback)

    return run


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return load()(arguments)


def main() -> None:
    """Entry point."""
    sys.exit(run_interruptibly("boat-sitl", load))


if __name__ == "__main__":
    main()
