"""Upload a way or a plan as the mission, read it back, then start it. One request, one answer.

Theory of operation
-------------------
The lists of an upload are sent one after the other. Once the boat has the last one, they are read back into
its item lists, where that is asked for, and compared. Only a mission that is as it was sent is started.
"""

from collections.abc import Callable
from typing import Final

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message
from companion.mavlink.items import MissionType
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed, Failed, FailureCause
from mission_tools.station.items import ItemLists
from mission_tools.station.outcome import Accepted, Answered, Cancelled, Outcome, Refused, Silent
from mission_tools.station.requests import BoatCommand
from mission_tools.station.uploads import ListUpload, Upload, first_difference
from mission_tools.station.words import LocalizedText, say

START_TIMEOUT_S: Final = 3.5
_RETRY_S: Final = 0.5


class Sailing:
    """At most one upload under way to a boat.

    send: to this boat; start: sends a command and reports its answer; lists: what the boat holds.
    """

    def __init__(
        self,
        boat: Address,
        own: Address,
        send: Callable[[Message], None],
        start: Callable[[BoatCommand, Answered, float, float], None],
        lists: ItemLists,
    ) -> None:
        self._boat = boat
        self._own = own
        self._sender = Sender(own, MissionType.MISSION)
        self._send = send
        self._start = start
        self._lists = lists
        self._answered: Answered | None = None
        self._upload: Upload | None = None
        self._waiting: list[ListUpload] = []  # to be sent, the first is under way
        self._sent_s: dict[str, float] = {}  # when the boat had a list, by kind
        self._deadline_s = 0.0

    @property
    def is_uploading(self) -> bool:
        """Whether messages of the mission protocol belong to the upload."""
        return self._answered is not None and bool(self._waiting)

    @property
    def is_active(self) -> bool:
        """Whether an upload is under way, until it is read back."""
        return self._upload is not None

    def ask(self, upload: Upload, answered: Answered, now_s: float) -> None:
        """Upload, read back and start. Replaces an upload that is under way."""
        self.cancel(now_s)
        self._answered, self._deadline_s = answered, now_s + upload.limit_s
        self._upload, self._waiting, self._sent_s = upload, list(upload.parts), {}
        self._offer(upload, now_s)

    def _offer(self, upload: Upload, now_s: float) -> None:
        part = self._waiting[0]
        self._sender = Sender(self._own, part.number, _RETRY_S, upload.retries)
        self._sender.offer(part.items, self._boat, now_s)
        self._post()

    def cancel(self, now_s: float) -> None:
        """A newer request steers the boat."""
        if self._answered is not None:
            self._stop(now_s)
            self._end(Cancelled())

    def handle(self, message: Message, now_s: float) -> None:
        """A message of the mission protocol from the boat."""
        self._sender.handle(message, self._boat, now_s)
        self._after(now_s)

    def poll(self, now_s: float) -> None:
        """Repeat what was lost, see what was read back, give up in time."""
        if not self._sender.is_idle:
            self._sender.tick(now_s)
            self._after(now_s)
        if self._upload is not None and not self._waiting:
            self._compare(self._upload, now_s)
        if self._upload is not None and now_s >= self._deadline_s:
            text = self._lateness(self._upload)
            self._stop(now_s)
            self._end(Silent(text))

    def _lateness(self, upload: Upload) -> LocalizedText:
        if not self._waiting:
            return say("answer.plan_unread")
        if self._sent_s:
            return say("answer.plan_partly", lists=", ".join(self._sent_s))
        return say("answer.plan_late") if upload.is_read_back else say("answer.way_late")

    def _after(self, now_s: float) -> None:
        self._post()
        for event in self._sender.take_events():
            upload = self._upload
            if upload is None or not self._waiting:
                continue
            if isinstance(event, Completed):
                part = self._waiting.pop(0)
                self._sent_s[part.kind] = now_s
                self._lists.may_have_changed(part.kind, now_s)
                if self._waiting:
                    self._offer(upload, now_s)
                elif not upload.is_read_back:
                    self._finish(upload, now_s)
            elif isinstance(event, Failed):
                self._waiting.clear()
                is_silent = event.cause is FailureCause.SILENT
                self._end(Silent() if is_silent else Refused(_refusal(upload, event.text)))

    def _compare(self, upload: Upload, now_s: float) -> None:
        """As soon as all lists were read again."""
        if any(self._lists.read_s(part.kind) < self._sent_s[part.kind] for part in upload.parts):
            return
        for part in upload.parts:
            other = first_difference(part, self._lists.items(part.kind) or ())
            if other is not None:
                self._end(Refused(say("answer.plan_differs", n=other, list=part.kind)))
                return
        self._finish(upload, now_s)

    def _finish(self, upload: Upload, now_s: float) -> None:
        if upload.start is None:
            self._end(Accepted(say("answer.plan_on_board")))
            return
        answered, self._answered, self._upload = self._answered, None, None
        if answered is not None:
            self._start(upload.start, answered, now_s, START_TIMEOUT_S)

    def _stop(self, now_s: float) -> None:
        if self._waiting:
            self._waiting.clear()
            self._sender.cancel(now_s)
            self._post()

    def _end(self, outcome: Outcome) -> None:
        answered, self._answered, self._upload = self._answered, None, None
        if answered is not None:
            answered(outcome)

    def _post(self) -> None:
        for message in self._sender.take_outbox():
            self._send(message)


def _refusal(upload: Upload, why: str) -> LocalizedText:
    is_plan = upload.is_read_back
    return say("answer.plan_refused", why=why) if is_plan else say("answer.way_refused", why=why)
