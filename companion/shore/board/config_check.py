"""The boat's own check of a configuration, `boat-companion check`, in a process of its own."""

import asyncio
import contextlib
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from msgspec import Struct

from companion.core.errors import StorageError
from companion.shore.board.toml_lines import line_of
from companion.shore.words import say

PROGRAM: Final = (sys.executable, "-I", "-m", "companion", "check", "--config")
_LONGEST_S: Final = 60.0  # a Pi Zero 2 W imports the boat in 8 s
_MOST_TEXT: Final = 2000
_NAME: Final = "boat.toml"
_PREFIX: Final = "boat-companion: "


class Complaint(Struct, frozen=True):
    """line: from 1; None where the boat names no key."""

    text: str
    line: int | None


async def check_text(text: str, program: Sequence[str] = PROGRAM) -> Complaint | None:
    """What the boat's program says against a configuration; None: nothing.

    Raises:
        StorageError: the check could not be made.
    """
    with tempfile.TemporaryDirectory(prefix="boat-shore-") as folder:
        file = Path(folder) / _NAME
        await asyncio.to_thread(file.write_bytes, text.encode())
        code, said = await _run([*program, str(file)])
    if code == 0:
        return None
    lines = [line for line in said.splitlines() if line.strip()]
    if not lines:
        raise StorageError(say("board.check.silent", n=code))
    complaint = lines[-1].removeprefix(_PREFIX).replace(f"{file}: ", "")[:_MOST_TEXT]
    return Complaint(complaint, await asyncio.to_thread(line_of, complaint, text))


async def _run(command: Sequence[str]) -> tuple[int, str]:
    """Its exit code and what it wrote to stderr."""
    try:
        process = await asyncio.create_subprocess_exec(
            *command,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
            cwd="/",
        )
    except OSError as error:
        raise StorageError(say("board.check.none", why=error.strerror or "")) from None
    try:
        async with asyncio.timeout(_LONGEST_S):
            _, said = await process.communicate()
    except TimeoutError:
        raise StorageError(say("board.check.late", n=_LONGEST_S)) from None
    finally:
        if process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                process.kill()
            await process.wait()
    return process.returncode or 0, said.decode("utf-8", "replace")
