"""The computer of the boat, when this program runs on it.

Links and load come from the boat's status file, temperature and disk from the system.
"""

import os
from pathlib import Path
from typing import Any, Final

import msgspec
from msgspec import Struct

from mission_tools.station.messages import LinkLoss

_PERIOD_S: Final = 1.0
_STALE_S: Final = 5.0  # the boat writes once a second
_THERMAL: Final = Path("/sys/class/thermal/thermal_zone0/temp")
_ROOT: Final = Path("/")


class _Link(Struct):
    """What is used of `companion.router.status.LinkStatus`."""

    name: str
    frames_in: int
    lost: int
    heard: list[str]


class _Links(Struct):
    links: list[_Link]


class _Status(Struct):
    """What is used of `companion.app.status_file.BoatStatus`, whose module would load the whole boat."""

    load: float
    links: _Links
    system_id: int = 0


class Board:
    """Read once a second. A file that is missing, broken or no longer written means: not known."""

    def __init__(self, status_file: Path, thermal: Path = _THERMAL, disk: Path = _ROOT) -> None:
        self._status_file = status_file
        self._thermal = thermal
        self._disk = disk
        self._due_s = float("-inf")
        self._written = 0  # when the file was last written, by its file system
        self._written_s = float("-inf")  # when that was seen
        self._fields: dict[str, Any] = {}
        self.boat: int | None = None  # the boat that runs on this computer, once it has said so

    def fields(self) -> dict[str, Any]:
        """The fields of a snapshot that are known."""
        return self._fields

    def poll(self, now_s: float) -> None:
        """Read the status file if it is due."""
        if now_s < self._due_s:
            return
        self._due_s = now_s + _PERIOD_S
        self._fields = {**self._status(now_s), **self._system()}

    def _status(self, now_s: float) -> dict[str, Any]:
        try:
            written = self._status_file.stat().st_mtime_ns
            if written != self._written:
                self._written, self._written_s = written, now_s
            elif now_s - self._written_s > _STALE_S:  # the boat's program has been killed
                return {}
            status = msgspec.json.decode(self._status_file.read_bytes(), type=_Status)
        except (OSError, msgspec.MsgspecError):
            return {}
        self.boat = status.system_id or self.boat
        return {"load": status.load, "links": [_loss(link) for link in status.links.links]}

    def _system(self) -> dict[str, Any]:
        fields: dict[str, Any] = {}
        try:
            disk = os.statvfs(self._disk)
            fields["disk_free_mb"] = round(disk.f_bavail * disk.f_frsize / 1e6)
            fields["temperature_c"] = round(int(self._thermal.read_text("ascii")) / 1e3, 1)
        except (OSError, ValueError):
            pass
        return fields


def _loss(link: _Link) -> LinkLoss:
    sent = link.frames_in + link.lost
    return LinkLoss(name=link.name, heard=link.heard, loss=link.lost / sent if sent > 0 else 0.0)
