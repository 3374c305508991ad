"""The net under the boat's tick: what becomes of a fault of ours.

The motors are off at once, whatever it is. A first fault leaves an armed boat on HOLD, where hardly anything
is computed and from where the operator may go on; faults that do not end disarm it; and if even then every
tick fails, the program ends, to be started anew with a clear head. Not so if a part with outputs is silent,
which no start cures: the boat keeps its links and says so.
"""

import logging
from enum import IntEnum

from companion.core.errors import SilentOutputsError

logger = logging.getLogger(__name__)

DISARM_LEVEL = 10.0
GIVE_UP_LEVEL = 50.0  # one second of nothing but faults
_FORGOTTEN_A_TICK = 0.02  # a good second makes good for one fault
_MOST_LOGGED = 20


class Fall(IntEnum):
    """How far it has come."""

    HOLD = 0
    DISARM = 1
    GIVE_UP = 2


class SafetyNet:
    """Counts. `faults` in all, `level` those that have not been made good for."""

    def __init__(self) -> None:
        self.faults = 0
        self.level = 0.0

    def passed(self) -> None:
        """A tick went well."""
        self.level = max(self.level - _FORGOTTEN_A_TICK, 0.0)

    def caught(self, error: Exception) -> Fall:
        """A tick went wrong."""
        self.faults += 1
        limit = DISARM_LEVEL if isinstance(error, SilentOutputsError) else GIVE_UP_LEVEL
        self.level = max(self.level, min(self.level + 1.0, limit))
        if self.faults <= _MOST_LOGGED:
            logger.error("fault %d in the boat's tick, motors off", self.faults, exc_info=error)
        if self.level >= GIVE_UP_LEVEL:
            return Fall.GIVE_UP
        return Fall.DISARM if self.level >= DISARM_LEVEL else Fall.HOLD
