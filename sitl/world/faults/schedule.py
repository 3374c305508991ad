"""The faults of one boat over time: scheduled, or begun and ended during the run."""

import heapq
import math
from collections.abc import Mapping, Sequence

import msgspec

from sitl.world.faults.catalogue import FaultSetting
from sitl.world.faults.parts import Part
from sitl.world.sampling import TIME_SLACK_S

# Parts without sampling: intermittent faults are switched here
_SWITCHED = frozenset(("motor_left", "motor_right", "link", "leak"))


class Faults:
    """The faults of one boat. A part has one fault at a time; a later one replaces it.

    The owner keeps now_s up to date and calls `step` when `due_s` has come.
    """

    def __init__(self, parts: Mapping[str, Part], planned: Sequence[FaultSetting] = ()) -> None:
        self.active: dict[str, FaultSetting] = {}
        self.due_s = math.inf
        self.now_s = 0.0
        self._parts = parts
        self._events: list[tuple[float, int, FaultSetting]] = []
        self._order = 0
        for fault in planned:
            self._plan(fault.at_s, fault)

    @property
    def parts(self) -> frozenset[str]:
        """The parts of this boat that can fail."""
        return frozenset(self._parts)

    def step(self) -> None:
        """Begin and end faults that are due."""
        now_s = self.now_s
        while self._events and now_s + TIME_SLACK_S >= self._events[0][0]:
            at_s, _, fault = heapq.heappop(self._events)
            if self.active.get(fault.what) is not fault:
                if at_s < fault.ends_s and fault.what in self._parts:
                    self._start(fault)
            elif at_s >= fault.ends_s:
                self.end(fault.what)
            else:
                self._toggle(fault)
        self._look_ahead()

    def begin(self, fault: FaultSetting) -> None:
        """Begin a fault now; its own at_s is ignored. Raises KeyError: this boat has no such part."""
        self._start(msgspec.structs.replace(fault, at_s=self.now_s))

    def end(self, what: str) -> None:
        """End the fault of a part. Raises KeyError: this boat has no such part."""
        self._parts[what](None, self.now_s)
        self.active.pop(what, None)

    def _start(self, fault: FaultSetting) -> None:
        part, now_s = self._parts[fault.what], self.now_s
        if fault.what in self.active:
            part(None, now_s)
        part(fault, now_s)
        self.active[fault.what] = fault
        if fault.ends_s < math.inf:
            self._plan(fault.ends_s, fault)
        if fault.kind == "intermittent" and fault.what in _SWITCHED:
            self._plan(now_s + 0.5 * fault.amount, fault)

    def _toggle(self, fault: FaultSetting) -> None:
        halves = round((self.now_s - fault.at_s) / (0.5 * fault.amount))
        self._parts[fault.what](fault if halves % 2 == 0 else None, self.now_s)
        self._plan(fault.at_s + (halves + 1) * 0.5 * fault.amount, fault)

    def _plan(self, at_s: float, fault: FaultSetting) -> None:
        self._order += 1
        heapq.heappush(self._events, (at_s, self._order, fault))
        self._look_ahead()

    def _look_ahead(self) -> None:
        self.due_s = self._events[0][0] - TIME_SLACK_S if self._events else math.inf
