"""boat-companion: the program on the boat."""

import sys
from typing import Any

from companion.cli.interrupts import Run, run_interruptibly


def load() -> Run:
    """Do the imports, which take a second; returns the program."""
    from companion.app.cli import run_program  # noqa: PLC0415 (an interrupt meanwhile ends without a traceback)

    return run_program


def main() -> None:
    """Entry point."""
    sys.exit(run_interruptibly("boat-companion", load))


def __getattr__(name: str) -> Any:  # noqa: ANN401 (a module's own)
    if name == "app":
        from companion.app.cli import app  # noqa: PLC0415 (as above)

        return app
    raise AttributeError(name)


if __name__ == "__main__":
    main()
