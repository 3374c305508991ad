"""The results of an experiment on disk: one line of JSON for each finished trial, in the order of their ends.

The first line holds the experiment's fingerprint and the program's version, which must match when the file is
opened again. An incomplete last line, left by an interruption, is dropped.
"""

import contextlib
from importlib.metadata import version
from pathlib import Path
from typing import IO

import msgspec
from msgspec import Struct

from companion.cli.output_file import output_file, output_folder
from companion.core.errors import ConfigError, OutputError
from sitl.experiments.campaign.campaign import Campaign
from sitl.experiments.trial import TrialResult

NAME = "runs.jsonl"
PLAN = "campaign.json"


class Head(Struct, frozen=True):
    """The first line."""

    campaign: str
    program: str


class ResultLog:
    """The open file. `results` begins with those of earlier sessions."""

    def __init__(self, folder: Path, campaign: Campaign) -> None:
        """Open or create the log; the folder is created.

        Raises ConfigError: the folder holds the runs of another campaign; OutputError: the folder cannot be
        written to.
        """
        output_folder(folder)
        self.path = folder / NAME
        self.results: dict[int, TrialResult] = {}
        head = Head(campaign.fingerprint, version("mavboat"))
        lines = self.path.read_bytes().splitlines(keepends=True) if self.path.exists() else []
        whole = [line for line in lines if line.endswith(b"\n")]
        if whole:
            self._check(whole[0], head)
            for number, line in enumerate(whole[1:], 2):
                result = self._parse(line, number)
                self.results[result.number] = result
        self._file: IO[bytes] = self.path.open("r+b" if lines else "wb")
        self._file.truncate(sum(map(len, whole)))
        self._file.seek(0, 2)
        if not whole:
            try:
                with output_file(folder / PLAN) as aside:
                    aside.write_bytes(msgspec.json.encode(campaign))
                self._write(msgspec.json.encode(head))
            except BaseException:
                self.close()
                raise

    def add(self, result: TrialResult) -> None:
        """Store a result; it survives an end of this program."""
        self.results[result.number] = result
        self._write(msgspec.json.encode(result))

    def close(self) -> None:
        """Close the file. `add` has reported a full disk before."""
        with contextlib.suppress(OSError):
            self._file.close()

    @classmethod
    def read(cls, folder: Path) -> tuple[Campaign, list[TrialResult]]:
        """A folder's campaign and its finished runs in order.

        Raises ConfigError: there is no campaign in it.
        """
        try:
            campaign = msgspec.json.decode((folder / PLAN).read_bytes(), type=Campaign)
        except (OSError, msgspec.DecodeError, UnicodeDecodeError, RecursionError):
            raise ConfigError(f"{folder}: no campaign in it: expected the folder of one") from None
        with contextlib.closing(cls(folder, campaign)) as log:
            return campaign, [log.results[number] for number in sorted(log.results)]

    def _parse(self, line: bytes, number: int) -> TrialResult:
        try:
            return msgspec.json.decode(line, type=TrialResult)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
            raise ConfigError(
                f"{self.path}: line {number} is damaged: remove it to run that trial again"
            ) from None

    def _check(self, line: bytes, head: Head) -> None:
        try:
            found = msgspec.json.decode(line, type=Head)
        except msgspec.DecodeError:
            raise ConfigError(f"{self.path}: not a campaign's runs: choose another folder") from None
        if found != head:
            other = "another campaign" if found.campaign != head.campaign else f"version {found.program}"
            raise ConfigError(
                f"{self.path}: holds the runs of {other}: remove it to start again, or choose another folder"
            )

    def _write(self, line: bytes) -> None:
        try:
            self._file.write(line + b"\n")
            self._file.flush()
        except OSError as error:
            raise OutputError.of(self.path, error) from None
