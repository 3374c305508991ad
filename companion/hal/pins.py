"""The Pi's pins through gpiozero, with one line that says what to do where they cannot be had."""

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

from companion.core.errors import HardwareError
from companion.hal.optional import import_optional

_PIPE = ".lgd-nfy"  # lgpio makes it in LG_WD or else the working directory, and cannot do without


@contextmanager
def opening_pins(part: str) -> Iterator[ModuleType]:
    """gpiozero, while the devices of a part are made of it.

    Raises:
        HardwareError: gpiozero is missing, there are no pins on this machine, or one is taken.
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
