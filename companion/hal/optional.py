"""Optional libraries, needed only for certain parts."""

import importlib
from types import ModuleType

from companion.core.errors import HardwareError


def import_optional(module: str, part: str) -> ModuleType:
    """Import a module of the extra `pi`.

    Raises:
        HardwareError: it is not installed or does not load; the message says what to do.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise HardwareError(
            f"{part}: the Python module {error.name or module!r} is missing; install mavboat[pi]"
        ) from None
    except Exception as error:
        raise HardwareError(
            f"{part}: the Python module {module!r} does not load on this machine ({_line(error)}); "
            "install mavboat[pi] anew, or set the part's driver to none"
        ) from error


def _line(error: Exception) -> str:
    """An error as one line."""
    return " ".join(str(error).split()) or type(error).__name__
