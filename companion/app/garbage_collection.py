"""Keeps Python's collector of reference cycles out of the control loop.

A full collection walks every object of the program, tens of milliseconds on a Pi: a late tick for nothing,
because a running boat makes values, not cycles. So what start-up has made is put aside for good, and the
young objects of the loop are looked at less often, and between two ticks.
"""

import gc

_YOUNG_OBJECTS = 20_000  # made and not freed again, before Python looks at them, be it in a tick
_SWEPT_OBJECTS = 4_000  # before they are looked at between ticks
_OLDER_EVERY = 20  # sweeps
_ROOM_S = (0.002, 0.005, 0.012)  # what a sweep of each generation may need on a Pi


def settle() -> None:
    """To be called when everything is built and before the loop begins; again, when it is built anew."""
    gc.unfreeze()
    gc.collect()
    gc.freeze()
    gc.set_threshold(_YOUNG_OBJECTS, 20, 20)


def sweep(left_s: float) -> None:
    """To be called by a real-time loop after each tick, with the time until the next one."""
    if left_s < _ROOM_S[0]:
        return
    young, middle, old = gc.get_count()
    if young < _SWEPT_OBJECTS:
        return
    generation = 0 if middle < _OLDER_EVERY else 1 if old < _OLDER_EVERY else 2
    while left_s < _ROOM_S[generation]:
        generation -= 1
    gc.collect(generation)
