"""The folder for missions, parameters and logs of a simulated boat between starts of `boat-sitl serve`.

A ground station keeps its plan when the emulator restarts, so the boat must keep it, too.
"""

import fcntl
import hashlib
import os
from pathlib import Path

from companion.cli.output_file import state_home
from companion.core.errors import BoatError, StorageError

NONE = "none"  # instead of a folder: nothing is stored


class StateInUseError(BoatError):
    """Another boat stores in this folder; two would overwrite each other's missions."""

    exit_code = 2


def default_folder(source: str, seed: int, port: int | None) -> Path | None:
    """The folder of a scenario and a TCP port (None: no TCP) under $XDG_STATE_HOME.

    Boats side by side differ by their ports. Port 0 means another one at every start: None, as nothing would
    be found again. Files of one name in several places get several folders; so does each seed's random world.
    """
    if port == 0:
        return None
    path = Path(source)
    name = path.stem
    if path.suffix:
        name += "-" + hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:8]
    if source == "random":
        name += f"-{seed}"
    return state_home() / f"{name}-{'udp' if port is None else port}"


def lock_folder(folder: Path) -> int:
    """Create the folder and lock it for other emulators until the returned descriptor is closed.

    Raises StorageError: it cannot be made; StateInUseError: another emulator has it.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    except OSError as error:
        raise StorageError(f"{folder}: cannot be used to store missions: {error.strerror}") from None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise StateInUseError(
            f"{folder}: another boat-sitl stores there: end it, or choose another --state DIR"
        ) from None
    return descriptor
