"""Requests by their id: each is done once, and asked again it gets the same answer."""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from mission_tools.station.messages import Answer, PageRequest

KEPT_S: Final = 600.0
MOST_KEPT: Final = 1000

Reply = Callable[[Answer], None]


@dataclass(slots=True)
class _Logged:
    asked_s: float
    answer: Answer | None = None
    waiting: list[Reply] = field(default_factory=list)


class RequestLog:
    """What was asked, in order of time."""

    def __init__(self) -> None:
        self._entries: OrderedDict[str, _Logged] = OrderedDict()

    def submit(
        self, request: PageRequest, reply: Reply, do: Callable[[PageRequest, Reply], None], now_s: float
    ) -> None:
        """Do a request, or answer one already seen. reply: called once, now or later."""
        self._forget(now_s)
        seen = self._entries.get(request.id)
        if seen is not None and seen.answer is not None:
            reply(seen.answer)
            return
        if seen is not None:
            if reply not in seen.waiting:
                seen.waiting.append(reply)
            return
        entry = _Logged(now_s, waiting=[reply])
        self._entries[request.id] = entry

        def on_answer(answer: Answer) -> None:
            if entry.answer is None:
                entry.answer = answer
                waiting, entry.waiting = entry.waiting, []
                for one in waiting:
                    one(answer)

        do(request, on_answer)

    def leave(self, reply: Reply) -> None:
        """A socket has closed: it waits for nothing any more."""
        for entry in self._entries.values():
            if reply in entry.waiting:
                entry.waiting.remove(reply)

    def _forget(self, now_s: float) -> None:
        while self._entries:
            entry = next(iter(self._entries.values()))
            if len(self._entries) < MOST_KEPT and now_s - entry.asked_s <= KEPT_S:
                return
            self._entries.popitem(last=False)
