"""A whole boat that writes logs, for tests: files in a folder, written at once."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from boat_rig import Rig
from pymavlink.DFReader import DFReader_binary

from companion.boat import Boat
from companion.core.storage import InlineExecutor
from companion.log.logbook import Logbook
from companion.log.onboard import OnboardLog
from companion.log.sink import FileSink, Sink, Worker
from companion.log.store import LogStore

Record = Any


class LogRig(Rig):
    """A Rig with a logbook. sink: in place of files."""

    def __init__(
        self,
        folder: Path,
        *settings: str,
        keeps_telemetry: bool = False,
        sink: Sink | None = None,
        worker: Worker | None = None,
        quota_mb: float = 100.0,
        config: dict[str, object] | None = None,
    ) -> None:
        worker = worker or Worker(InlineExecutor())
        self.store = LogStore(folder, quota_mb)
        self.logbook = Logbook(
            sink or FileSink(self.store, worker), self.store, worker, keeps_telemetry=keeps_telemetry
        )
        super().__init__("open", *settings, config=config)

    def _build(self) -> Boat:
        return Boat(self.config, self.hardware, [self.port], self.storage, logbook=self.logbook)

    @property
    def log(self) -> OnboardLog:
        """The boat's own log."""
        assert self.logbook.onboard is not None
        return self.logbook.onboard

    def disarm(self) -> None:
        """Disarm and let the log come to its end."""
        self.ask(400, 0.0)
        self.run(self.config.log.after_disarm_s + 0.1)


class MemorySink:
    """A sink in memory. takes: it has room for blocks."""

    def __init__(self) -> None:
        self.fault = ""
        self.room_bytes = 100
        self.takes = True
        self.blocks: list[bytes] = []
        self.begun = 0

    def begin(self) -> bool:
        self.begun += 1
        self.fault = ""
        return True

    def write(self, block: bytes, unix_s: float) -> bool:
        if self.takes:
            self.blocks.append(block)
        return self.takes

    def end(self) -> None:
        """Nothing to complete."""

    def close(self) -> None:
        """Nothing to release."""


OpenRig = Callable[..., LogRig]  # what LogRig takes


def read_log(path: Path) -> list[Record]:
    """Every record of a log, as pymavlink reads it."""
    with DFReader_binary(str(path), zero_time_base=True) as reader:
        records = []
        while (record := reader.recv_msg()) is not None:
            records.append(record)
        return records


def of_kind(records: list[Record], name: str) -> list[Record]:
    """The records of one kind."""
    return [record for record in records if record.get_type() == name]
