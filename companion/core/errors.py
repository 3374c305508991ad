"""What can go wrong, as one tree:

    BoatError
    ├── ConfigError      (ValueError)  a key or value of the configuration; names key and expectation
    ├── StorageError     (OSError)     a file of the boat's memory cannot be read or written
    ├── OutputError      (OSError)     a file that a program was to write for its user
    ├── HardwareError    (OSError)     a part of the boat does not answer
    │   └── LinkError                  a port that carries MAVLink cannot be opened
    └── LocalProtocolError (RuntimeError)  our own code asked a protocol machine for what its state forbids

What arrives on the wire never raises past the endpoint: it is dropped and counted. `exit_code` is what a
program ends with: 1 the job failed, 2 wrong input, 3 no link.
"""

import errno
from pathlib import Path
from typing import Self

_FULL = (errno.ENOSPC, errno.EDQUOT)


class BoatError(Exception):
    """Root of every error that the companion raises on purpose."""

    exit_code = 1


class ConfigError(BoatError, ValueError):
    """A configuration that cannot be used."""

    exit_code = 2


class StorageError(BoatError, OSError):
    """The boat's memory (missions, parameters) cannot be read or written."""


class OutputError(BoatError, OSError):
    """A file that was asked for cannot be written."""

    @classmethod
    def of(cls, path: Path, error: OSError) -> Self:
        """What the system said of a file, and what to do."""
        why = error.strerror or str(error) or type(error).__name__
        do = "make room, or name another place" if error.errno in _FULL else "name another place"
        return cls(f"{path}: cannot be written: {why}: {do}")


class HardwareError(BoatError, OSError):
    """A part of the boat does not answer."""


class LinkError(HardwareError):
    """A port that carries MAVLink cannot be opened."""

    exit_code = 3


class LocalProtocolError(BoatError, RuntimeError):
    """Our own code asked a protocol machine for what its state forbids."""
