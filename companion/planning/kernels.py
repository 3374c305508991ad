"""Compiled kernels where they were built, their pure-Python twins elsewhere.

pip builds the kernels where there is a C compiler (setup.py). With MAVBOAT_PURE=1 in the environment the
twins run in any case; both return the same results.
"""

import os
from importlib import import_module
from types import ModuleType


def load(compiled: str, twin: str) -> ModuleType:
    """The compiled module of this package, or its twin."""
    package = __name__.rpartition(".")[0]
    if os.environ.get("MAVBOAT_PURE", "0") in ("", "0"):
        try:
            return import_module(f"{package}.{compiled}")
        except ImportError:
            pass
    return import_module(f"{package}.{twin}")
