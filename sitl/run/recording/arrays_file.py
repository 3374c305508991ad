"""One .npz file with arrays by name and everything else as JSON in it: how runs and recordings are kept."""

import json
import zipfile
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from companion.cli.output_file import output_file
from companion.core.errors import ConfigError

Built = TypeVar("Built")


def save_arrays(path: Path, rest: Mapping[str, Any], **arrays: NDArray[Any]) -> None:
    """Write the file, whole or not at all.

    Raises:
        OutputError: it cannot be written.
    """
    as_bytes = np.frombuffer(json.dumps(rest).encode(), dtype=np.uint8)
    with output_file(path) as aside, aside.open("wb") as file:  # a file: numpy would add a suffix
        np.savez_compressed(file, allow_pickle=False, rest=as_bytes, **arrays)


def load_arrays(
    path: Path, expected: str, build: Callable[[dict[str, Any], dict[str, NDArray[Any]]], Built]
) -> Built:
    """What is built of the JSON and of the arrays by name.

    Args:
        path: the file.
        expected: what it must be, for the error: "the record of a run".
        build: makes the object; what it misses or cannot read is an error of the file.

    Raises:
        ConfigError: it cannot be read, or is no such file.
    """
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        return build(json.loads(arrays.pop("rest").tobytes()), arrays)
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file: expected {expected}") from None
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise ConfigError(f"{path}: not {expected}: {error}") from None
