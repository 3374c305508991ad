"""The logs that one boat keeps, with their dates.

The folder is listed by MAVLink FTP. Dates are not in that list: they come with LOG_ENTRY, which counts the
logs from the oldest one; docs/logs.md tells how.
"""

import re
from collections.abc import Callable
from typing import Final

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.ftp_frames import Code
from mission_tools.station.ftp.client import FtpClient
from mission_tools.station.ftp.jobs import Entry, FtpFailure
from mission_tools.station.messages import LogFile
from mission_tools.station.words import say

FRESH_S: Final = 5.0
MOST_LOGS: Final = 500
_DATES_S: Final = 1.5  # to wait for the dates
_FOLDERS: Final = ("@LOGS", "/APM/LOGS")  # this boat's alias; ArduPilot's folder
_NAME: Final = re.compile(r"0*(\d{1,9})\.bin", re.ASCII | re.IGNORECASE)
_ALL: Final = 0xFFFF


class LogList:
    """request() now and then, while somebody looks. logs: newest first; None while they are not known.

    failure: why they are not. path: of a log on the boat.
    """

    def __init__(self, boat: Address, send: Callable[[Message], None], files: FtpClient) -> None:
        self.logs: list[LogFile] | None = None
        self.failure: str | None = None
        self._boat = boat
        self._send = send
        self._files = files
        self._folder = 0  # in _FOLDERS
        self._entries: list[tuple[int, Entry]] | None = None  # by number, while dates are waited for
        self._dates: dict[int, tuple[int, int]] = {}  # Unix time and size by LOG_ENTRY's id
        self._is_listing = False
        self._asked_s = self._dates_s = float("-inf")
        self._now_s = 0.0

    def request(self) -> None:
        """Somebody wants the list: read it again if it is old."""
        if self._is_listing or self._entries is not None or self._now_s - self._asked_s < FRESH_S:
            return
        self._asked_s = self._now_s
        self._list()

    def path(self, name: str) -> str | None:
        """Where a listed log is on the boat; None for another name."""
        found = any(log.name == name for log in self.logs or ())
        return f"{_FOLDERS[self._folder]}/{name}" if found else None

    def handle(self, entry: Message) -> None:
        """The date and size of one log."""
        if self._entries is None or not 0 <= entry.id <= entry.num_logs <= MOST_LOGS:
            return
        place = entry.num_logs - entry.id if entry.id else 0  # the newest has a second number, 0
        self._dates[place] = entry.time_utc, entry.size
        if len(self._dates) >= min(entry.num_logs, len(self._entries)):
            self._finish()

    def poll(self, now_s: float) -> None:
        """Wait for the dates no longer than useful."""
        self._now_s = now_s
        if self._entries is not None and now_s - self._dates_s > _DATES_S:
            self._finish()

    def _list(self) -> None:
        self._is_listing = True
        self._files.list_folder(_FOLDERS[self._folder], self._on_list)

    def _on_list(self, found: list[Entry] | FtpFailure) -> None:
        self._is_listing = False
        if isinstance(found, FtpFailure):
            if found.code == Code.FILE_NOT_FOUND and self._folder + 1 < len(_FOLDERS):
                self._folder += 1
                self._list()
                return
            self._folder = 0
            is_missing = found.code == Code.FILE_NOT_FOUND
            self.failure = say("log.none") if is_missing else found.text
            self.logs = None
            return
        numbered = [
            (int(match[1]), one)
            for one in found
            if (match := _NAME.fullmatch(one.name)) and one.size is not None
        ]
        self._entries = sorted(numbered, reverse=True)[:MOST_LOGS]
        self._dates.clear()
        self._dates_s = self._now_s
        if not self._entries:
            self._finish()
            return
        self._send(dialect.MAVLink_log_request_list_message(*self._boat, 0, _ALL))

    def _finish(self) -> None:
        entries, self._entries = self._entries or [], None
        self.failure = None
        self.logs = [
            LogFile(name=one.name, bytes=one.size or 0, at_s=self._date(place, one.size or 0))
            for place, (_, one) in enumerate(entries)
        ]

    def _date(self, place: int, size: int) -> float | None:
        """Of a log, counted from the newest, which may have grown; None if LOG_ENTRY is of another file."""
        unix_s, entry_size = self._dates.get(place, (0, 0))
        is_same = entry_size == size or (place == 0 and entry_size > size)
        return float(unix_s) if unix_s and is_same else None
