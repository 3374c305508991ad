"""python -m mission_tools.shore.voyage FILE: a log's voyage as JSON on standard output; see docs/shore.md.

Exit code 1 and {"text", "key", "values"} if it cannot be shown. The process limits its own time and memory,
as the file is from outside.
"""

import mmap
import os
import resource
import sys
from pathlib import Path
from typing import Final

import msgspec

from mission_tools.shore.voyage.voyage import NoVoyageError, read_voyage
from mission_tools.station.words import say

MOST_BYTES: Final = 200_000_000
_MOST_MEMORY_BYTES: Final = 600_000_000  # of address space: the file is mapped
_MOST_CPU_S: Final = 90
_NICE: Final = 10  # the boat's program may run on the same computer


def main(file: Path) -> int:
    """Read, print, and say how it ended."""
    resource.setrlimit(resource.RLIMIT_AS, (_MOST_MEMORY_BYTES, _MOST_MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CPU, (_MOST_CPU_S, _MOST_CPU_S))
    os.nice(_NICE)
    try:
        answer, code = _voyage(file), 0
    except NoVoyageError as error:
        answer, code = error.text.to_page(), 1
    except MemoryError:
        answer, code = say("voyage.memory").to_page(), 1
    sys.stdout.buffer.write(msgspec.json.encode(answer))
    return code


def _voyage(file: Path) -> object:
    try:
        size = file.stat().st_size
        if size > MOST_BYTES:
            mb = size // 1_000_000
            raise NoVoyageError(say("voyage.too_large", n=mb, most=MOST_BYTES // 1_000_000))
        if not size:
            return read_voyage(b"")
        with (
            file.open("rb") as opened,
            mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as mapped,
            memoryview(mapped) as data,
        ):
            return read_voyage(data)
    except OSError as error:
        raise NoVoyageError(say("voyage.unreadable", why=error.strerror or "")) from None


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
