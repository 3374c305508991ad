"""A ground station with the habits of a row of `client_habits`: it waits, repeats and gives up as that one.

Everything is asked over a `Line` and counted: what was asked, what was asked again, what was never answered.
"""

import math
from collections import Counter, deque
from collections.abc import Callable, Sequence
from typing import NamedTuple

from client_habits import PATIENT, Habits
from pymavlink.dialects.v20 import all as dialect
from vehicle_line import PERFECT, Line, Message, Who

REQUESTS = ("MISSION_REQUEST_INT", "MISSION_REQUEST")
ITEMS = ("MISSION_ITEM_INT", "MISSION_ITEM")
_HEARTBEAT_S = 1.0
VEHICLE = Who(1, 1)


class Item(NamedTuple):
    """A mission item as it goes over the wire."""

    command: int
    frame: int
    x: int
    y: int
    z: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    p3: float = 0.0
    p4: float = 0.0


class Answered(NamedTuple):
    """How a command was answered: MAV_RESULT, and the message that was asked for with it."""

    result: int
    message: Message | None = None


class StationClient:
    """One station on one line."""

    def __init__(self, line: Line, habits: Habits, vehicle: Who = VEHICLE) -> None:
        self.line = line
        self.habits = habits
        self.vehicle = vehicle
        self.asked: Counter[str] = Counter()
        self.asked_again: Counter[str] = Counter()
        self.unanswered: Counter[str] = Counter()
        self.texts: list[str] = []
        self._unread: deque[Message] = deque()
        self._heartbeat_s = -math.inf

    def send(self, message: Message) -> None:
        """One message."""
        self.line.send(message)

    def hear(self, wanted: Callable[[Message], object], timeout_s: float) -> Message | None:
        """The next message that is wanted, None when time is up. Others are not kept."""
        give_up_s = self.line.now_s + timeout_s
        while True:
            while self._unread:
                message = self._unread.popleft()
                if message.get_type() == "STATUSTEXT":
                    self.texts.append(message.text)
                if Who(message.get_srcSystem(), message.get_srcComponent()) == self.vehicle and wanted(
                    message
                ):
                    return message
            if self.line.now_s >= give_up_s:
                return None
            if self.line.now_s >= self._heartbeat_s + _HEARTBEAT_S:
                self.heartbeat()
            self._unread.extend(self.line.listen(min(give_up_s, self._heartbeat_s + _HEARTBEAT_S)))

    def hear_one(self, name: str, timeout_s: float, **fields: float) -> Message | None:
        """The next message of a type whose fields have these values."""
        return self.hear(
            lambda m: m.get_type() == name and all(getattr(m, key) == value for key, value in fields.items()),
            timeout_s,
        )

    def forget(self) -> None:
        """Let go of what has come and was not read."""
        self._unread.clear()
        while self.line.listen(self.line.now_s):
            pass

    def heartbeat(self) -> None:
        """Say that a ground station is here."""
        self._heartbeat_s = self.line.now_s
        self.send(dialect.MAVLink_heartbeat_message(dialect.MAV_TYPE_GCS, 8, 192, 0, 4, 3))

    def ask(
        self, what: str, message: Message, wanted: Callable[[Message], object], wait_s: float, tries: int
    ) -> Message | None:
        """Send, and send again, until what is wanted comes."""
        for number in range(tries):
            self.asked[what] += 1
            self.asked_again[what] += number > 0
            self.send(message)
            if (answer := self.hear(wanted, wait_s)) is not None:
                return answer
        self.unanswered[what] += 1
        return None

    # Commands

    def command(
        self, number: int, *params: float, brings: int | None = None, component: int = 1
    ) -> Answered | None:
        """COMMAND_LONG; brings: the message that has to come with an acceptance. None: not answered."""
        habits, came = self.habits, dict[int, Message]()

        def is_answer(message: Message) -> bool:
            if message.get_msgId() == brings:
                came[message.get_msgId()] = message
            return bool(message.get_type() == "COMMAND_ACK" and message.command == number)

        values = [*params, *[0.0] * (7 - len(params))]
        request = dialect.MAVLink_command_long_message(self.vehicle.system, component, number, 0, *values)
        what = f"command {number} {params[0] if params else ''}".strip()
        ack = self.ask(what, request, is_answer, habits.command_wait_s, habits.command_tries)
        if ack is None:
            return None
        if brings is not None and ack.result == dialect.MAV_RESULT_ACCEPTED and brings not in came:
            message = self.hear(lambda m: m.get_msgId() == brings, 1.0)
            if message is None:
                self.unanswered[what] += 1
            return Answered(ack.result, message)
        return Answered(ack.result, came.get(brings) if brings is not None else None)

    # Plans

    def upload(self, items: Sequence[Item], mission_type: int = 0) -> int | None:
        """Replace a list; the MAV_MISSION_RESULT, or None where the client gives up."""
        habits, target = self.habits, self.vehicle

        def concerns(message: Message) -> bool:
            name = message.get_type()
            return bool((name in REQUESTS or name == "MISSION_ACK") and message.mission_type == mission_type)

        count = dialect.MAVLink_mission_count_message(*target, len(items), mission_type)
        heard = self.ask("upload", count, concerns, habits.count_wait_s, habits.count_tries)
        while heard is not None:
            if heard.get_type() == "MISSION_ACK":
                return int(heard.type)
            self.send(item_message(items[heard.seq], heard.seq, target, mission_type))
            heard = self.hear(concerns, habits.patience_s)
        return None

    def download(self, mission_type: int = 0) -> list[Item] | None:
        """The list that the vehicle holds, None where the client gives up."""
        habits, target = self.habits, self.vehicle
        offered = self.ask(
            f"list {mission_type}",
            dialect.MAVLink_mission_request_list_message(*target, mission_type),
            lambda m: m.get_type() == "MISSION_COUNT" and m.mission_type == mission_type,
            habits.list_wait_s,
            habits.list_tries,
        )
        if offered is None:
            return None
        items: dict[int, Item] = {}
        tries: Counter[int] = Counter()
        due_s: dict[int, float] = {}
        while len(items) < offered.count:
            first = next(seq for seq in range(offered.count) if seq not in items)
            for seq in range(first, min(first + habits.window, offered.count)):
                if seq in items or self.line.now_s < due_s.get(seq, -math.inf):
                    continue
                if tries[seq] == habits.item_tries:
                    self.unanswered[f"item {mission_type}"] += 1
                    return None
                self.asked[f"item {mission_type}"] += 1
                self.asked_again[f"item {mission_type}"] += tries[seq] > 0
                tries[seq] += 1
                due_s[seq] = self.line.now_s + habits.item_wait_s
                self.send(dialect.MAVLink_mission_request_int_message(*target, seq, mission_type))
            next_s = min(at_s for seq, at_s in due_s.items() if seq not in items)
            message = self.hear(
                lambda m: m.get_type() in ITEMS and m.mission_type == mission_type, next_s - self.line.now_s
            )
            if message is not None:
                items[message.seq] = item_of(message)
        if habits.acknowledges:
            self.send(dialect.MAVLink_mission_ack_message(*target, 0, mission_type))
        return [items[seq] for seq in range(offered.count)]

    # Parameters

    def parameters(self) -> dict[str, float] | None:
        """All of them, as a list, with the gaps asked for by index; None where the client gives up."""
        habits = self.habits
        held: dict[int, Message] = {}
        is_value = lambda m: m.get_type() == "PARAM_VALUE" and m.param_index != 0xFFFF  # noqa: E731
        first = self.ask(
            "parameters",
            dialect.MAVLink_param_request_list_message(self.vehicle.system, 0),
            is_value,
            habits.parameter_wait_s,
            habits.parameter_tries,
        )
        while first is not None:
            held[first.param_index] = first
            count = first.param_count
            first = self.hear(is_value, 0.5) if len(held) < count else None
        for _ in range(habits.parameter_tries * (len(held) > 0)):
            missing = [index for index in range(count) if index not in held]
            for start in range(0, len(missing), habits.parameter_batch):
                self._read_by_index(missing[start : start + habits.parameter_batch], held)
        if not held or len(held) < count:
            return None
        return {value.param_id: value.param_value for value in held.values()}

    def _read_by_index(self, batch: list[int], held: dict[int, Message]) -> None:
        for index in batch:
            self.asked["parameter"] += 1
            self.send(dialect.MAVLink_param_request_read_message(*self.vehicle, b"", index))
        wanted = set(batch)
        while wanted:
            value = self.hear(lambda m: m.get_type() == "PARAM_VALUE" and m.param_index in wanted, 1.0)
            if value is None:
                return
            held[value.param_index] = value
            wanted.discard(value.param_index)

    def set_parameter(self, name: str, value: float, kind: int = 9) -> float | None:
        """PARAM_SET; the value that the vehicle says it now has, None where it says nothing."""
        answer = self.ask(
            "set",
            dialect.MAVLink_param_set_message(*self.vehicle, name.encode(), value, kind),
            lambda m: m.get_type() == "PARAM_VALUE" and m.param_id == name,
            self.habits.parameter_wait_s,
            self.habits.parameter_tries,
        )
        return None if answer is None else float(answer.param_value)


def item_message(item: Item, seq: int, target: Who, mission_type: int) -> Message:
    """The MISSION_ITEM_INT that carries an item."""
    return dialect.MAVLink_mission_item_int_message(
        *target, seq, item.frame, item.command, 0, 1, *item[5:9], item.x, item.y, item.z, mission_type
    )


def item_of(message: Message) -> Item:
    """What a MISSION_ITEM_INT carries; "unchanged" is not told from "unchanged"."""
    m = message
    params = (0.0 if value != value else value for value in (m.param1, m.param2, m.param3, m.param4))  # noqa: PLR0124
    return Item(m.command, m.frame, m.x, m.y, m.z, *params)


def truth(station: StationClient, mission_type: int = 0) -> list[Item] | None:
    """What the vehicle holds, read over the same line made perfect by a client that never gives up."""
    quality, habits = station.line.quality, station.habits
    station.line.quality = PERFECT
    station.hear(lambda _: False, 1.0)  # what is under way arrives
    patient = StationClient(station.line, PATIENT, station.vehicle)
    held = patient.download(mission_type)
    station.line.quality, station.habits = quality, habits
    return held


OpenClient = Callable[..., StationClient]  # habits, then quality and seed
