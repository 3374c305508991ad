"""What starts a program of the planner: it imports for a second, and may be interrupted meanwhile."""

import sys
from collections.abc import Callable
from importlib import import_module

from companion.cli.interrupts import Run, run_interruptibly


def program(name: str, family: str = "mission") -> tuple[Callable[[], None], Run]:
    """Of `mission-NAME`, whose command is in NAME_command.py: its entry point, and what runs it in Python."""

    def load() -> Run:
        run: Run = import_module(f"mission_tools.cli.{name}_command").run_program
        return run

    def main() -> None:
        sys.exit(run_interruptibly(f"{family}-{name}", load))

    def run_program(arguments: list[str]) -> int:
        return load()(arguments)

    return main, run_program
