"""Mission, fence and rally list of one boat, downloaded by the mission protocol.

A list is read again at once when the boat says that it is another one (the ids in MISSION_CURRENT, or another
number of items), and from time to time for boats that do not say so.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Literal

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message
from companion.mavlink.items import MissionItem, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.transfer import Completed, Failed
from mission_tools.station.geojson import fence_geojson, mission_geojson, rally_geojson
from mission_tools.station.messages import ItemList

Kind = Literal["mission", "fence", "rally"]
KINDS: Final[dict[Kind, MissionType]] = {
    "mission": MissionType.MISSION, "fence": MissionType.FENCE, "rally": MissionType.RALLY,
}  # fmt: skip
AGAIN_S: Final = 30.0  # between readings of a list
AGAIN_SHARE: Final = 0.1  # of the link's time, at most, for reading a long list again
AFTER_FAILURE_S: Final = 10.0
_MOST_ITEMS: Final = 5000
_RETRY_S, _RETRIES = 1.0, 10  # of a hundred items, where a fifth of the frames is lost, all arrive


@dataclass(slots=True)
class _List:
    items: tuple[MissionItem, ...] | None = None
    version: int = 0
    due_s: float = float("-inf")
    read_s: float = float("-inf")
    geojson: dict[str, Any] | None = None


class ItemLists:
    """The three lists. send: to this boat."""

    def __init__(self, boat: Address, own: Address, send: Callable[[Message], None]) -> None:
        self._boat = boat
        self._own = own
        self._send = send
        self._lists: dict[Kind, _List] = {kind: _List() for kind in KINDS}
        self._reading: Kind | None = None
        self._began_s = 0.0
        self._receiver = Receiver(own, MissionType.MISSION)
        self._ids: tuple[int, ...] | None = None

    @property
    def is_reading(self) -> bool:
        """Whether a download is under way."""
        return self._reading is not None

    def summary(self, kind: Kind) -> ItemList | None:
        """Count and version; home is not counted. None until downloaded."""
        one = self._lists[kind]
        if one.items is None:
            return None
        count = max(len(one.items) - 1, 0) if kind == "mission" else len(one.items)
        return ItemList(count=count, version=one.version)

    def geojson(self, kind: Kind) -> dict[str, Any] | None:
        """The list as a FeatureCollection; None until downloaded."""
        one = self._lists[kind]
        if one.items is None:
            return None
        if one.geojson is None:
            build = {"mission": mission_geojson, "fence": fence_geojson, "rally": rally_geojson}[kind]
            one.geojson = build(one.items)
        return one.geojson

    def items(self, kind: Kind) -> tuple[MissionItem, ...] | None:
        """The list as on the wire; None until downloaded."""
        return self._lists[kind].items

    def read_s(self, kind: Kind) -> float:
        """When the latest download of this list began."""
        return self._lists[kind].read_s

    def may_have_changed(self, kind: Kind, now_s: float) -> None:
        """Read this list again soon."""
        self._lists[kind].due_s = min(self._lists[kind].due_s, now_s)

    def on_ids(self, ids: tuple[int, ...], now_s: float) -> None:
        """The ids that the boat gives its lists, in the order of KINDS; 0: none."""
        for kind, before, now in zip(KINDS, self._ids or ids, ids, strict=True):
            if now != before:
                self.may_have_changed(kind, now_s)
        self._ids = ids

    def pause(self, now_s: float) -> None:
        """Give up the download under way: an upload needs the line. It is due again."""
        if self._reading is not None:
            self._lists[self._reading].due_s = now_s
            self._reading = None
            self._receiver.cancel(now_s)
            self._post()

    def handle(self, message: Message, now_s: float) -> None:
        """A message of the mission protocol from the boat."""
        if self._reading is not None:
            self._receiver.handle(message, self._boat, now_s)
            self._after(now_s)

    def poll(self, now_s: float, is_heard: bool) -> None:
        """Start the download that is due, and repeat what was lost."""
        if self._reading is not None:
            self._receiver.tick(now_s)
            self._after(now_s)
            return
        if not is_heard:
            return
        for kind, one in self._lists.items():
            if now_s >= one.due_s:
                self._reading, self._began_s = kind, now_s
                self._receiver = Receiver(self._own, KINDS[kind], _RETRY_S, _RETRIES, _MOST_ITEMS)
                self._receiver.request_list(self._boat, now_s)
                self._post()
                return

    def _after(self, now_s: float) -> None:
        for event in self._receiver.take_events():
            if self._reading is None:
                break
            one = self._lists[self._reading]
            if isinstance(event, Completed):
                self._receiver.confirm(now_s)
                self._keep(self._reading, event.items)
                one.due_s = now_s + AGAIN_S + (now_s - self._began_s) / AGAIN_SHARE
                one.read_s = self._began_s
                self._reading = None
            elif isinstance(event, Failed):
                one.due_s = now_s + AFTER_FAILURE_S
                self._reading = None
        self._post()

    def _keep(self, kind: Kind, items: tuple[MissionItem, ...]) -> None:
        """Home, item 0 of a mission, follows the boat before it is armed: that is no new version."""
        one, first = self._lists[kind], 1 if kind == "mission" else 0
        one.version += one.items is None or items[first:] != one.items[first:]
        one.items, one.geojson = items, None

    def _post(self) -> None:
        for message in self._receiver.take_outbox():
            self._send(message)
