"""Give memory back to the system that was needed for a moment only.

glibc keeps what a thread has freed for that thread's next need: after PIN checks in several threads, or a
start that compiled Python's caches, the program stayed at 130 to 150 MB.
"""

import ctypes
import gc
from typing import Final

_M_MMAP_THRESHOLD: Final = -3  # mallopt(3), malloc.h
_M_ARENA_MAX: Final = -8
_LARGE_BYTES: Final = 1 << 20  # larger blocks go back as they are freed; by default this grows up to 32 MB


def settle() -> None:
    """Call once, before the first thread, when everything is imported."""
    gc.collect()
    gc.freeze()  # a full collection then does not walk every module while the pages wait
    libc = ctypes.CDLL(None)
    if hasattr(libc, "malloc_trim"):  # of glibc; other libraries give back by themselves
        libc.mallopt(_M_MMAP_THRESHOLD, _LARGE_BYTES)
        libc.mallopt(_M_ARENA_MAX, 1)
        libc.malloc_trim(0)
