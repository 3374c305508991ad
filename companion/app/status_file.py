"""The running boat's status in a small file, once a second, for `boat-companion links`.

Written by a thread, because a medium may take its time and the control loop must not wait; aside and renamed,
so that a reader finds the old content or the new; not flushed, because nothing depends on its survival.
"""

import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import msgspec

from companion.boat import Boat
from companion.config.boat_config import BoatConfig
from companion.core.errors import BoatError, ConfigError, StorageError
from companion.core.status_text import Severity
from companion.core.tick_count import TickCount
from companion.router.status import LinksStatus, Reporter
from companion.services.corrections import CorrectionStatus

PERIOD_S = 1.0
RUNTIME_DIRECTORY = Path("/run/mavboat")  # of the installed unit
_NAME = "status.json"


class BoatStatus(msgspec.Struct, frozen=True):
    """What the file holds. load is the share of the tick used; late ticks began more than 5 ms late."""

    process: int
    load: float
    ticks: int
    late_ticks: int
    skipped_ticks: int
    worst_late_s: float
    links: LinksStatus
    corrections: CorrectionStatus | None = None  # of the GNSS receiver, as the boat passed them on
    system_id: int = 0  # of the boat, by MAVLink
    missing: dict[str, str] = {}  # parts and links that cannot be opened, and why


class StatusFile:
    """Writes a status at most once a second, and none while the one before is still under way."""

    def __init__(self, path: Path, boat: Boat, missing: Callable[[], dict[str, str]] = dict) -> None:
        """missing: parts and links that cannot be opened, and why."""
        self._path, self._boat, self._missing = path, boat, missing
        self._reporter = Reporter(boat.channels)
        self._is_well = True
        self._worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="status")
        self._writing: Future[None] | None = None
        self._due_s = 0.0

    def tick(self, now_s: float, ticks: TickCount, load: float) -> None:
        """Call every tick. The operator is told of a write that failed, once until one succeeds."""
        if now_s < self._due_s or (self._writing is not None and not self._writing.done()):
            return
        self._due_s = now_s + PERIOD_S
        error = None if self._writing is None else self._writing.exception()
        was_well, self._is_well = self._is_well, error is None
        if error is not None and was_well:
            why = (isinstance(error, OSError) and error.strerror) or error
            self._boat.vehicle.notify(Severity.WARNING, f"Status file {self._path} cannot be written: {why}")
        status = BoatStatus(
            process=os.getpid(),
            load=load,
            ticks=ticks.run,
            late_ticks=ticks.late,
            skipped_ticks=ticks.skipped,
            worst_late_s=ticks.worst_s,
            links=self._reporter.report(now_s),
            corrections=self._boat.endpoint.corrections.status(now_s),
            system_id=self._boat.address.system,
            missing=self._missing(),
        )
        self._writing = self._worker.submit(_write, self._path, status)

    def close(self) -> None:
        """Wait for what is under way, and take the file away: nobody runs any more. May be called twice."""
        self._worker.shutdown(wait=True)
        with suppress(OSError):  # a medium that has become read-only
            self._path.unlink(missing_ok=True)


def status_path(config: BoatConfig) -> Path | None:
    """Where a boat of this configuration writes its status; None if it writes none.

    Its unit's runtime directory is in memory, which reduces writes to the card.
    """
    storage = config.storage
    if storage.status_file:
        return Path(storage.status_file).expanduser()
    if runtime := os.environ.get("RUNTIME_DIRECTORY"):
        return Path(runtime) / _NAME
    return Path(storage.folder).expanduser() / _NAME if storage.folder else None


def find_status(config: BoatConfig, runtime: Path = RUNTIME_DIRECTORY) -> Path:
    """The same for a program outside the unit, without its runtime directory. ConfigError: it writes none."""
    own, of_unit = status_path(config), runtime / _NAME
    if not config.storage.status_file and of_unit.exists():
        return of_unit
    if own is None:
        raise ConfigError("storage.folder: the boat keeps no status; set it, or storage.status_file")
    return own


def read_status(path: Path) -> BoatStatus:
    """The status of the boat that runs. Raises StorageError: there is no such file, or it is none of ours."""
    try:
        return msgspec.json.decode(path.read_bytes(), type=BoatStatus)
    except FileNotFoundError:
        raise StorageError(f"{path}: no such file; is the boat running?") from None
    except (OSError, msgspec.MsgspecError) as error:
        raise StorageError(f"{path}: cannot be read: {error}") from None


def running_boat(config: BoatConfig, root: Path = Path("/")) -> BoatStatus | None:
    """The status of the boat that uses the parts now, None without one. root: of the system's files."""
    try:
        status = read_status(find_status(config, root / RUNTIME_DIRECTORY.relative_to("/")))
    except BoatError:
        return None
    return status if (root / "proc" / str(status.process)).exists() else None


def _write(path: Path, status: BoatStatus) -> None:
    aside = path.with_name(path.name + ".new")
    aside.write_bytes(msgspec.json.encode(status))
    aside.replace(path)
