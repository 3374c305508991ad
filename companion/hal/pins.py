"""The Pi's pins through gpiozero, with an explanation if they are not available."""

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

from companion.core.errors import HardwareError
from companion.hal.optional import import_optional

_PIPE = ".lgd-nfy"  # created by lgpio in LG_WD or the working directory


@contextmanager
def opening_pins(part: str) -> Iterator[ModuleType]:
    """gpiozero, in a context that explains its errors.

    Raises:
        HardwareError: gpiozero is missing, there are no pins, or one is in use.
    """
    gpiozero = import_optional("gpiozero", part)
    with warnings.catch_warnings(record=True) as fallbacks:  # why gpiozero could not use lgpio
        warnings.simplefilter("always")
        try:
            yield gpiozero
        except Exception as error:
            reasons = [str(one.message) for one in fallbacks]
            raise HardwareError(f"{part}: the pins cannot be opened: {_reason(error, reasons)}") from error


def _reason(error: Exception, fallbacks: list[str]) -> str:
    if any(_PIPE in reason for reason in fallbacks):
        return f"lgpio cannot write to {os.getcwd()}; start in a folder of this user's, or name one in LG_WD"
    first = f" ({fallbacks[0]})" if fallbacks else ""
    return " ".join(f"{error}{first}".split())
