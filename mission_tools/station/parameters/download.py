"""The list of a boat's parameters, downloaded as ground stations do.

Theory of operation
-------------------
While somebody wants the list: PARAM_REQUEST_LIST, again every LIST_S until the first PARAM_VALUE tells the
count. The boat then sends one after the other as its line allows. Once nothing new has come for QUIET_S,
what is missing is asked for by index, REPAIR_COUNT every REPAIR_S, round and round; if more than half is
missing, the list is asked for again instead. After GIVE_UP_S without anything new from a boat that is heard,
the rest counts as missing, and is asked for again AGAIN_S later. When nobody wants the list, or the boat is
silent, nothing is asked; what came is kept, and the download goes on from there.

Another count, a restart of the boat, or its silence after the download begins the list anew: indexes may have
moved, values changed. A value that comes unasked replaces the known one at any time, as the boat broadcasts
what any station sets.
"""

from collections.abc import Callable
from typing import Final, Literal

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.parameters.values import Value, decode, name_of

MOST: Final = 10_000  # ArduPilot has some 1,500, PX4 some 2,000
LIST_S: Final = 4.0
QUIET_S: Final = 1.0
REPAIR_S: Final = 0.5
REPAIR_COUNT: Final = 10  # 20 a second: under 1 kB/s each way
GIVE_UP_S: Final = 15.0
AGAIN_S: Final = 60.0
ANEW_S: Final = 10.0  # between beginnings, if the count changes again and again
_UNASKED: Final = 0xFFFF  # param_index of a PARAM_VALUE outside the list

State = Literal["waiting", "loading", "here"]


class Download:
    """The values by name. version: counts up with every change."""

    def __init__(self, boat: Address, send: Callable[[Message], None]) -> None:
        self._boat = boat
        self._send = send
        self.values: dict[str, Value] = {}
        self.version = 0
        self.is_bytewise = False
        self._asked_s = self._began_s = float("-inf")
        self.restart()

    def restart(self) -> None:
        """The values on board may be others; those known are kept until then."""
        self.count: int | None = None
        self._names: dict[int, str | None] = {}  # by index; None: a name that cannot be shown
        self._is_over = self._is_listed = False  # _is_listed: the list was asked for
        self._was_active = False
        self._news_s = self._over_s = float("-inf")
        self._next = 0  # index from which the repair goes on
        self.version += 1

    @property
    def state(self) -> State:
        """here: all is known, or the boat does not answer for the rest."""
        return "here" if self._is_over else "waiting" if self.count is None else "loading"

    @property
    def got(self) -> int:
        """Entries of the list that have come."""
        return len(self._names)

    def handle(self, message: Message, now_s: float) -> tuple[str, Value] | None:
        """PARAM_VALUE. Returns name and value; None if it cannot be used."""
        name, value = name_of(message), decode(message, self.is_bytewise)
        index, count = int(message.param_index), min(int(message.param_count), MOST)
        if index < count:
            self._note(index, count, name, now_s)
        if name is None or (name not in self.values and len(self.values) >= MOST):
            return None
        if self.values.get(name) != value:
            self.values[name] = value
            self.version += 1
        return name, value

    def _note(self, index: int, count: int, name: str | None, now_s: float) -> None:
        if self.count is not None and self.count != count:
            if now_s - self._began_s < ANEW_S:
                return
            self.restart()
        if self.count is None:
            self.count, self._began_s = count, now_s
        if self._names.get(index, "") != name:
            self._names[index] = name
            self._news_s = now_s
            self.version += 1
        if len(self._names) >= count and not self._is_over:
            self._end(now_s)
            listed = set(self._names.values())
            self.values = {name: value for name, value in self.values.items() if name in listed}

    def poll(self, now_s: float, is_wanted: bool) -> None:
        """Ask for what is missing. is_wanted: and the boat is heard."""
        if not is_wanted:
            self._was_active = False
            return
        if not self._was_active:
            self._was_active, self._news_s = True, now_s
        if self._is_over:
            if self.missing and now_s - self._over_s >= AGAIN_S:
                self._is_over, self._news_s = False, now_s
            return
        if self.count is None or not self._is_listed:
            if now_s - self._asked_s >= LIST_S:
                self._ask_list(now_s)
        elif now_s - self._news_s >= GIVE_UP_S:
            self._end(now_s)
        elif now_s - self._news_s >= QUIET_S:
            self._repair(now_s)

    @property
    def missing(self) -> int:
        """Entries of the list that have not come."""
        return 0 if self.count is None else self.count - len(self._names)

    def _repair(self, now_s: float) -> None:
        assert self.count is not None  # noqa: S101
        if 2 * self.missing > self.count:
            if now_s - self._asked_s >= LIST_S:
                self._ask_list(now_s)
            return
        if now_s - self._asked_s < REPAIR_S:
            return
        self._asked_s = now_s
        missing = [index for index in range(self.count) if index not in self._names]
        later = [index for index in missing if index >= self._next]
        batch = [*later, *missing][: min(REPAIR_COUNT, len(missing))]
        for index in batch:
            self._send(dialect.MAVLink_param_request_read_message(*self._boat, b"", index))
        self._next = batch[-1] + 1

    def _ask_list(self, now_s: float) -> None:
        self._asked_s, self._is_listed = now_s, True
        self._send(dialect.MAVLink_param_request_list_message(*self._boat))

    def _end(self, now_s: float) -> None:
        self._is_over, self._over_s = True, now_s
        self.version += 1
