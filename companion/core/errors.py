"""The tree of errors:

    BoatError
    ├── ConfigError      (ValueError)  a key or value of the configuration; names key and expectation
    ├── UsageError       (ValueError)  arguments that do not go together
    ├── StorageError     (OSError)     a stored file cannot be read or written
    ├── OutputError      (OSError)     an output file cannot be written
    ├── HardwareError    (OSError)     a part of the boat does not answer
    │   ├── LinkError                  a port that carries MAVLink cannot be opened
    │   └── SilentOutputsError         a part with outputs does not answer; no restart cures that
    └── LocalProtocolError (RuntimeError)  a local call that the state of a protocol machine forbids

Data from the wire never raises past the endpoint: it is dropped and counted. `exit_code`: 1 the job failed,
2 wrong input, 3 no link.
"""

import errno
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Self

_FULL = (errno.ENOSPC, errno.EDQUOT)


class BoatError(Exception):
    """Root of all errors that the companion raises on purpose.

    figures: what a job that failed has measured; `--json` prints them with the error, as one object.
    """

    exit_code = 1
    figures: Mapping[str, object] = MappingProxyType({})

    def with_figures(self, figures: Mapping[str, object]) -> Self:
        """The same error, with what was measured."""
        self.figures = figures
        return self


class ConfigError(BoatError, ValueError):
    """An invalid configuration."""

    exit_code = 2


class UsageError(BoatError, ValueError):
    """Arguments of a command line that do not go together."""

    exit_code = 2


class StorageError(BoatError, OSError):
    """A stored file (mission, parameters) cannot be read or written."""


class OutputError(BoatError, OSError):
    """An output file cannot be written."""

    @classmethod
    def of(cls, path: Path, error: OSError) -> Self:
        """From a file and the system's error, with advice."""
        why = error.strerror or str(error) or type(error).__name__
        do = "make room, or name another place" if error.errno in _FULL else "name another place"
        return cls(f"{path}: cannot be written: {why}: {do}")


class HardwareError(BoatError, OSError):
    """A hardware part does not respond."""


class LinkError(HardwareError):
    """A port that carries MAVLink cannot be opened."""

    exit_code = 3


class SilentOutputsError(HardwareError):
    """A part with outputs does not respond, which no restart of the program cures.

    are_off: they have been switched off in another way; otherwise they go on with their last signals.
    """

    def __init__(self, text: str, *, are_off: bool) -> None:
        super().__init__(text)
        self.are_off = are_off


class LocalProtocolError(BoatError, RuntimeError):
    """A local call that the state of a protocol machine forbids."""
