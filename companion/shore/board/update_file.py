"""An update that the page hands to the boat: a wheel in a folder, and a file that starts its installation.

Theory of operation
-------------------
    FOLDER/.upload-…/NAME.whl   while it arrives and is checked
    FOLDER/new/NAME.whl         waits: whole, on the medium, checked
    FOLDER/start                asks the boat's installer to begin; the installer removes it
    result.json                 what became of it, from the installer, which is another user

The page's program only fills the folder. The installer checks the wheel again, as whoever writes into the
folder need not be this program.
"""

import asyncio
import contextlib
import os
import re
import shutil
import stat
import sys
import tempfile
from collections.abc import AsyncIterator, Sequence
from pathlib import Path
from typing import Annotated, Any, BinaryIO, Final, Literal

import msgspec
from msgspec import Meta, Struct

from companion import __version__
from companion.core.errors import BoatError, ConfigError, StorageError
from companion.shore.words import say

RESULT: Final = Path("/var/lib/mavboat-update/result.json")
MOST_BYTES: Final = 30_000_000  # wheel_file.MOST_PACKED_BYTES; its zipfile and email are not kept in memory
CHECK: Final = (sys.executable, "-I", "-m", "companion.shore.board.wheel_check")
_CHECK_S: Final = 60.0  # a Pi Zero 2 W starts Python in 1 s and hashes 20 MB/s
_MOST_RESULT_BYTES: Final = 16_000
_MOST_TEXT: Final = 2_000
_NAME: Final = re.compile(r"[A-Za-z0-9][A-Za-z0-9._+!-]{0,115}\.whl", re.ASCII)  # as wheel_file: 120 at most
_UPLOAD: Final = ".upload-"

State = Literal["running", "done", "went back", "refused"]
_Version = Annotated[str, Meta(max_length=120)]


class Wheel(Struct, frozen=True):
    """What waits. name: of the file."""

    name: str
    version: str


class Result(Struct, frozen=True):
    """Of the latest installation. before: the version before it. at_s: Unix time."""

    state: State
    version: _Version = ""
    before: _Version = ""
    text: str = ""
    at_s: float = 0.0


class UpdateState(Struct, frozen=True):
    """What the page shows. trouble: for its `told`, where the result cannot be read."""

    present: str
    waiting: Wheel | None
    is_running: bool
    result: Result | None
    trouble: dict[str, Any] | None


class UpdateRefusedError(ConfigError):
    """Not now. Its one argument is the text for people."""


class WrongWheelError(ConfigError):
    """A file that is not taken."""


class TooLargeError(ConfigError):
    """More bytes than a wheel may have."""


class UpdateFolder:
    """Where an update is handed over. One upload at a time."""

    def __init__(self, folder: Path, result: Path = RESULT, check: Sequence[str] = CHECK) -> None:
        self.folder = folder
        self._result = result
        self._check = check
        self._busy = asyncio.Lock()

    @property
    def _new(self) -> Path:
        return self.folder / "new"

    @property
    def _start(self) -> Path:
        return self.folder / "start"

    def state(self) -> UpdateState:
        """Blocks for a moment: call it in a thread."""
        result, trouble = None, None
        try:
            result = _read_result(self._result)
        except StorageError as error:
            trouble = error.args[0].to_page()
        is_running = os.path.lexists(self._start) or (result is not None and result.state == "running")
        return UpdateState(__version__, self._waiting(), is_running, result, trouble)

    async def receive(self, name: str, chunks: AsyncIterator[bytes]) -> Wheel:
        """Take a wheel as it arrives, check it, and put it where it waits, in place of an earlier one.

        Raises:
            WrongWheelError, TooLargeError: the file is not taken.
            UpdateRefusedError: another upload or an installation is under way.
            StorageError: it cannot be written or checked.
        """
        if _NAME.fullmatch(name) is None:
            raise WrongWheelError(say("board.update.name"))
        if self._busy.locked():
            raise UpdateRefusedError(say("board.update.busy"))
        async with self._busy:
            self._refuse_while_running()
            try:
                return await self._receive(name, chunks)
            except OSError as error:
                raise self._unwritable(error) from None

    async def _receive(self, name: str, chunks: AsyncIterator[bytes]) -> Wheel:
        room = await asyncio.to_thread(self._make_room)
        try:
            with await asyncio.to_thread((room / name).open, "xb") as file:
                await _fill(file, chunks)
                await asyncio.to_thread(os.fsync, file.fileno())
            wheel = await self._checked(room / name)
            self._refuse_while_running()  # it was long
            await asyncio.to_thread(self._put, room / name)
        finally:
            await asyncio.to_thread(shutil.rmtree, room, ignore_errors=True)
        return wheel

    def _make_room(self) -> Path:
        """A folder of its own, as the check wants the file's own name. Earlier ones are of a power cut."""
        for left in self.folder.glob(f"{_UPLOAD}*"):
            shutil.rmtree(left, ignore_errors=True)
        self._new.mkdir(exist_ok=True)
        return Path(tempfile.mkdtemp(prefix=_UPLOAD, dir=self.folder))

    def _put(self, path: Path) -> None:
        path.chmod(0o644)
        path.replace(self._new / path.name)
        for other in self._new.iterdir():
            if other.name != path.name:
                _remove(other)
        _sync(self._new)

    async def _checked(self, path: Path) -> Wheel:
        code, out, said = await self._run([*self._check, str(path)])
        if code == 0:
            with contextlib.suppress(msgspec.DecodeError):
                return msgspec.json.decode(out, type=Wheel)
        lines = said.decode("utf-8", "replace").strip().splitlines()
        if code != 2 or not lines:
            raise StorageError(say("board.update.no_check", n=code))
        raise WrongWheelError(lines[-1][:_MOST_TEXT])

    async def _run(self, command: Sequence[str]) -> tuple[int, bytes, bytes]:
        pipe = asyncio.subprocess.PIPE
        process = await asyncio.create_subprocess_exec(
            *command, stdin=asyncio.subprocess.DEVNULL, stdout=pipe, stderr=pipe, cwd="/"
        )
        try:
            async with asyncio.timeout(_CHECK_S):
                out, said = await process.communicate()
        except TimeoutError:
            raise StorageError(say("board.check.late", n=_CHECK_S)) from None
        finally:
            if process.returncode is None:
                with contextlib.suppress(ProcessLookupError):
                    process.kill()
                await process.wait()
        return process.returncode or 0, out, said

    def install(self) -> None:
        """Ask the installer to begin. Blocks: call it in a thread.

        Raises:
            UpdateRefusedError: nothing waits, or it is under way.
            StorageError: it cannot be asked.
        """
        if self._busy.locked():
            raise UpdateRefusedError(say("board.update.busy"))
        self._refuse_while_running()
        if self._waiting() is None:
            raise UpdateRefusedError(say("board.update.nothing"))
        try:
            os.close(os.open(self._start, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644))
            _sync(self.folder)
        except OSError as error:
            raise self._unwritable(error) from None

    def drop(self) -> None:
        """Remove what waits, and a request that nobody has taken. Blocks: call it in a thread.

        Raises:
            UpdateRefusedError: an upload is under way.
            StorageError: it cannot be removed.
        """
        if self._busy.locked():
            raise UpdateRefusedError(say("board.update.busy"))
        try:
            self._start.unlink(missing_ok=True)
            for one in list(self._new.iterdir()) if self._new.is_dir() else []:
                _remove(one)
        except OSError as error:
            raise self._unwritable(error) from None

    def _waiting(self) -> Wheel | None:
        """The name was checked with the file, so it has the version."""
        with contextlib.suppress(OSError):
            for one in sorted(self._new.iterdir()):
                if _NAME.fullmatch(one.name) and "-" in one.name and stat.S_ISREG(one.lstat().st_mode):
                    return Wheel(one.name, one.name.split("-")[1])
        return None

    def _refuse_while_running(self) -> None:
        if os.path.lexists(self._start):
            raise UpdateRefusedError(say("board.update.installs"))

    def _unwritable(self, error: OSError) -> BoatError:
        return StorageError(say("board.unwritable", file=str(self.folder), why=error.strerror or ""))


async def _fill(file: BinaryIO, chunks: AsyncIterator[bytes]) -> None:
    size = 0
    async for chunk in chunks:
        size += len(chunk)
        if size > MOST_BYTES:
            raise TooLargeError(say("board.update.large", n=MOST_BYTES // 1_000_000))
        await asyncio.to_thread(file.write, chunk)
    await asyncio.to_thread(file.flush)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _sync(folder: Path) -> None:
    """The names in it, on the medium."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _read_result(path: Path) -> Result | None:
    """None: nothing was installed so far.

    Raises:
        StorageError: it cannot be read, or is not as expected.
    """
    content: bytes | None = None
    try:
        flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
        with os.fdopen(os.open(path, flags), "rb") as file:
            if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                content = file.read(_MOST_RESULT_BYTES + 1)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise StorageError(say("board.unreadable", file=str(path), why=error.strerror or "")) from None
    if content is None or len(content) > _MOST_RESULT_BYTES:
        raise StorageError(say("board.update.damaged", file=str(path)))
    try:
        return msgspec.json.decode(content, type=Result)
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        raise StorageError(say("board.update.damaged", file=str(path))) from None
