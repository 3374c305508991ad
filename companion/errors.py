"""What can go wrong, as one tree:

    BoatError
    ├── ConfigError      (ValueError)  a key or value of the configuration; names key and expectation
    ├── StorageError     (OSError)     a file of the boat's memory cannot be read or written
    ├── HardwareError    (OSError)     a part of the boat does not answer
    │   └── LinkError                  a port that carries MAVLink cannot be opened
    └── LocalProtocolError (RuntimeError)  our own code asked a protocol machine for what its state forbids

What arrives on the wire never raises past the endpoint: it is dropped and counted. `exit_code` is what a
program ends with: 1 the job failed, 2 wrong input, 3 no link.
"""


class BoatError(Exception):
    """Root of every error that the companion raises on purpose."""

    exit_code = 1


class ConfigError(BoatError, ValueError):
    """A configuration that cannot be used."""

    exit_code = 2


class StorageError(BoatError, OSError):
    """The boat's memory (missions, parameters) cannot be read or written."""


class HardwareError(BoatError, OSError):
    """A part of the boat does not answer."""


class LinkError(HardwareError):
    """A port that carries MAVLink cannot be opened."""

    exit_code = 3


class LocalProtocolError(BoatError, RuntimeError):
    """Our own code asked a protocol machine for what its state forbids."""
