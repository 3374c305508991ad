"""Sail a planned way: upload it as the mission, then start it. One request, one answer."""

from collections.abc import Callable
from typing import Final

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import MissionItem, MissionType
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed, Failed
from companion.shore.station.commands import NO_ANSWER, REPLACED, Answered
from companion.shore.station.requests import Command
from companion.shore.words import say

UPLOAD_S: Final = 6.0  # leaves time for the start within the ten seconds of a request
START_TIMEOUT_S: Final = 3.5
_TOO_SLOW: Final = say("answer.way_late")
_FIRST: Final = 1.0  # the item after home
_START: Final = Command(dialect.MAV_CMD_MISSION_START, (_FIRST,), say("answer.sail"), once=True)
_RETRY_S, _RETRIES = 0.5, 4


def way_items(way: list[tuple[int, int]]) -> list[MissionItem]:
    """Home (which the boat replaces by its own) and a waypoint for each point."""
    frame = dialect.MAV_FRAME_GLOBAL_RELATIVE_ALT
    points = [way[0], *way]
    return [MissionItem(frame=frame, command=dialect.MAV_CMD_NAV_WAYPOINT, x=x, y=y) for x, y in points]


class Sailing:
    """At most one way under way to a boat.

    send: to this boat; start: sends a command and reports its answer; uploaded: the boat has a new
    mission.
    """

    def __init__(
        self,
        boat: Address,
        own: Address,
        send: Callable[[Message], None],
        start: Callable[[Command, Answered, float, float], None],
        uploaded: Callable[[float], None],
    ) -> None:
        self._boat = boat
        self._sender = Sender(own, MissionType.MISSION, _RETRY_S, _RETRIES)
        self._send = send
        self._start = start
        self._uploaded = uploaded
        self._answered: Answered | None = None
        self._deadline_s = 0.0

    @property
    def is_uploading(self) -> bool:
        """Whether messages of the mission protocol belong to the upload."""
        return self._answered is not None

    def ask(self, way: list[tuple[int, int]], answered: Answered, now_s: float) -> None:
        """Upload and start. Replaces a way whose upload is under way."""
        self.cancel(now_s)
        self._answered, self._deadline_s = answered, now_s + UPLOAD_S
        self._sender.offer(way_items(way), self._boat, now_s)
        self._post()

    def cancel(self, now_s: float) -> None:
        """A newer request steers the boat."""
        if self._answered is not None:
            self._sender.cancel(now_s)
            self._post()
            self._end(REPLACED)

    def handle(self, message: Message, now_s: float) -> None:
        """A message of the mission protocol from the boat."""
        self._sender.handle(message, self._boat, now_s)
        self._after(now_s)

    def poll(self, now_s: float) -> None:
        """Repeat what was lost, give up in time."""
        if not self._sender.is_idle:
            self._sender.tick(now_s)
            self._after(now_s)
        if self._answered is not None and now_s >= self._deadline_s:
            self._sender.cancel(now_s)
            self._post()
            self._end(_TOO_SLOW)

    def _after(self, now_s: float) -> None:
        self._post()
        for event in self._sender.take_events():
            answered = self._answered
            if isinstance(event, Completed):
                self._uploaded(now_s)
                self._answered = None
                if answered is not None:
                    self._start(_START, answered, now_s, START_TIMEOUT_S)
            elif isinstance(event, Failed):
                silent = event.text.startswith(("no answer", "the partner"))
                self._end(NO_ANSWER if silent else say("answer.way_refused", why=event.text))

    def _end(self, text: str) -> None:
        answered, self._answered = self._answered, None
        if answered is not None:
            answered(False, text)

    def _post(self) -> None:
        for message in self._sender.take_outbox():
            self._send(message)
