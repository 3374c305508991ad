"""The finished runs of a campaign on disk, one line of JSON each, in the order in which they ended.

The first line says which campaign, and which version of the program, so that runs of another are never taken
for this one's. A last line that an interruption has cut short is dropped.
"""

import contextlib
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import IO, Self

import msgspec
from msgspec import Struct

from companion.core.errors import ConfigError, OutputError
from companion.core.output_file import output_file, output_folder
from sitl.experiments.campaign.campaign import Campaign
from sitl.experiments.campaign.run import Outcome

NAME = "runs.jsonl"
PLAN = "campaign.json"


class Head(Struct, frozen=True):
    """The first line."""

    campaign: str
    program: str


class Ledger:
    """The file, open for more. `outcomes` holds those of earlier sessions at first, then all."""

    def __init__(self, folder: Path, campaign: Campaign) -> None:
        """Open or begin the ledger in a folder, which is made.

        Raises:
            ConfigError: the folder holds the runs of another campaign.
            OutputError: the folder cannot be written to.
        """
        output_folder(folder)
        self.path = folder / NAME
        self.outcomes: dict[int, Outcome] = {}
        head = Head(campaign.fingerprint, version("mavboat"))
        lines = self.path.read_bytes().splitlines(keepends=True) if self.path.exists() else []
        whole = [line for line in lines if line.endswith(b"\n")]
        if whole:
            self._check(whole[0], head)
            for number, line in enumerate(whole[1:], 2):
                outcome = self._parse(line, number)
                self.outcomes[outcome.number] = outcome
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

    def add(self, outcome: Outcome) -> None:
        """Keep a finished run: it survives this program from now on."""
        self.outcomes[outcome.number] = outcome
        self._write(msgspec.json.encode(outcome))

    def in_order(self) -> list[Outcome]:
        """What has been kept, by the runs' numbers."""
        return [self.outcomes[number] for number in sorted(self.outcomes)]

    def close(self) -> None:
        """Let the file go. What a full disk has not taken has been told before."""
        with contextlib.suppress(OSError):
            self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @classmethod
    def read(cls, folder: Path) -> tuple[Campaign, list[Outcome]]:
        """A folder's campaign and its finished runs in order.

        Raises:
            ConfigError: there is no campaign in it.
        """
        try:
            campaign = msgspec.json.decode((folder / PLAN).read_bytes(), type=Campaign)
        except (OSError, msgspec.DecodeError, UnicodeDecodeError, RecursionError):
            raise ConfigError(
                f"{folder}: no campaign in it: expected a folder that one was sailed to"
            ) from None
        with cls(folder, campaign) as ledger:
            return campaign, ledger.in_order()

    def _parse(self, line: bytes, number: int) -> Outcome:
        try:
            return msgspec.json.decode(line, type=Outcome)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
            raise ConfigError(
                f"{self.path}: line {number} is damaged: remove it, and the same command sails that run again"
            ) from None

    def _check(self, line: bytes, head: Head) -> None:
        try:
            found = msgspec.json.decode(line, type=Head)
        except msgspec.DecodeError:
            raise ConfigError(f"{self.path}: not a campaign's runs: choose another folder") from None
        if found != head:
            other = "another campaign" if found.campaign != head.campaign else f"version {found.program}"
            raise ConfigError(
                f"{self.path}: holds the runs of {other}: remove it to begin anew, or choose another folder"
            )

    def _write(self, line: bytes) -> None:
        try:
            self._file.write(line + b"\n")
            self._file.flush()
        except OSError as error:
            raise OutputError.of(self.path, error) from None
