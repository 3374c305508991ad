"""Libraries that only a boat with the part needs."""

import importlib
from types import ModuleType

from companion.errors import HardwareError


def import_optional(module: str, part: str) -> ModuleType:
    """Import a module of the extra `pi`.

    Raises:
        HardwareError: it is not installed; the message says what to install.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise HardwareError(
            f"{part}: the Python module {error.name or module!r} is missing; install mavboat[pi]"
        ) from None
