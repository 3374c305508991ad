"""`mission-upload`: plan a mission, upload it, start it and follow it."""

import sys

from companion.cli.interrupts import Run, run_interruptibly


def load() -> Run:
    """Do the imports, which take a second; returns the program."""
    from mission_tools.cli.upload_command import run_program as run  # noqa: PLC0415 (may be interrupted)

    return run


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return load()(arguments)


def main() -> None:
    """Run mission-upload and end the process with its exit code."""
    sys.exit(run_interruptibly("mission-upload", load))


if __name__ == "__main__":
    main()
