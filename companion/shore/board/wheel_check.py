"""Checks a wheel in a process of its own, as it reads the whole file.

python -m companion.shore.board.wheel_check FILE

Prints version and name as JSON, or says on stderr what was expected.
"""

import json
import sys
from pathlib import Path

from companion.core.errors import ConfigError
from companion.core.wheel_file import inspect_wheel


def main(path: str) -> int:
    """Its exit code."""
    try:
        found = inspect_wheel(Path(path))
    except ConfigError as refused:
        sys.stderr.write(f"{refused}\n")
        return 2
    sys.stdout.write(json.dumps({"version": found.version, "name": found.name}) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
