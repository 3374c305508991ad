"""Keeps Python's collector of reference cycles out of the control loop.

A full collection walks every object of the program, tens of milliseconds on a Pi: a late tick for nothing,
because a running boat makes values, not cycles. So what start-up has made is put aside for good, and the
young objects of the loop are looked at less often.
"""

import gc

_YOUNG_OBJECTS = 20_000  # made and not freed again, before anything is looked at


def settle() -> None:
    """To be called once by a program, when everything is built and before the loop begins."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(_YOUNG_OBJECTS, 20, 20)
