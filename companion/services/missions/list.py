"""One stored list (mission, fence, rally): its content, its uploads, and its saves."""

import zlib
from collections.abc import Callable, Sequence
from dataclasses import InitVar, dataclass, field
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, position_to_e7
from companion.core.storage import Saving, Storage
from companion.mavlink.address import Address
from companion.mavlink.dialect import dialect
from companion.mavlink.items import ItemFault, MissionItem, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed, TransferState
from companion.payload.fitted import FittedPayload
from companion.persistence.mission_store import encode_item, load_items, save_lines
from companion.services.missions.area_items import check_fence, check_fence_item, check_rally_item
from companion.services.missions.items import check_jumps, to_step
from companion.vehicle.mission.steps import Home, Step


class ListEntry(NamedTuple):
    """An item, its mission step (Home in other lists), and its line on disk."""

    item: MissionItem
    step: Step
    line: bytes


class Part(NamedTuple):
    """Items requested without a transfer, still to be sent."""

    partner: Address
    next_seq: int
    last_seq: int


@dataclass(eq=False)
class MissionList:
    """Its items are replaced as a whole, once the new ones are stored."""

    _own: Address
    type: MissionType
    config: InitVar[BoatConfig]
    _storage: Storage
    _fitted: FittedPayload
    entries: tuple[ListEntry, ...] = field(default=(), init=False)
    steps: tuple[Step, ...] = field(default=(), init=False)  # the mission steps
    id: int = field(default=0, init=False)  # of the content; 0 if empty
    upload_channel: int = field(default=0, init=False)
    senders: dict[int, Sender] = field(default_factory=dict, init=False)
    parts: dict[int, Part] = field(default_factory=dict, init=False)
    saving: Saving | None = field(default=None, init=False)
    loss: str = field(default="", init=False)  # what of the stored list is lost, and what is used instead

    def __post_init__(self, config: BoatConfig) -> None:
        self.home: Callable[[], LatLon | None] = lambda: None  # set by the owner
        self._arriving: list[ListEntry] = []
        self._arrived: tuple[ListEntry, ...] = ()
        self.most = {
            MissionType.MISSION: config.mission.max_items,
            MissionType.FENCE: config.mission.max_fence_items,
            MissionType.RALLY: config.mission.max_rally_items,
        }[self.type]
        self._timers = timers = config.mavlink
        self.receiver = Receiver(self._own, self.type, timers.retry_s, timers.retries, self.most, self._check)
        self._load()

    @property
    def items(self) -> tuple[MissionItem, ...]:
        return tuple([entry.item for entry in self.entries])

    def offered(self) -> tuple[MissionItem, ...]:
        """The items sent to stations: item 0 of a mission is home, as on ArduPilot, not the uploaded one."""
        home = self.home() if self.type is MissionType.MISSION else None
        return self.items if home is None else (_home_item(home), *self.items[1:])[: len(self.entries)]

    @property
    def is_idle(self) -> bool:
        return not (self.senders or self.parts or self.saving) and self.receiver.state is TransferState.IDLE

    def sender(self, channel: int) -> Sender:
        if channel not in self.senders:
            timers = self._timers
            self.senders[channel] = Sender(
                self._own, self.type, timers.retry_s, timers.retries, source=self.offered
            )
        return self.senders[channel]

    def store(self, completed: Completed) -> ItemFault | None:
        """Check an uploaded list, or part of one, and start saving it. A fault if it is inconsistent."""
        entries = tuple(self._arriving[: len(completed.items)])
        self._arriving = []
        if completed.first is not None:
            after = completed.first + len(entries)
            entries = self.entries[: completed.first] + entries + self.entries[after:]
        if fault := self._check_whole(entries):
            return fault
        self._arrived = entries
        self.saving = save_lines(self._storage, self.type, [entry.line for entry in entries])
        return None

    def swap_in(self) -> None:
        """Replace the list after it was stored."""
        self.entries, self._arrived = self._arrived, ()
        self.steps = tuple([entry.step for entry in self.entries])
        self.id = zlib.crc32(b"".join([entry.line for entry in self.entries]))

    def drop(self) -> None:
        """Drop a list that could not be stored."""
        self._arrived = ()

    def clear(self) -> Saving:
        """Start saving an empty list, for `swap_in`."""
        self._arrived = ()
        return save_lines(self._storage, self.type, ())

    def _load(self) -> None:
        items, self.loss = load_items(self._storage, self.type)
        faults = (
            f"item {seq}: {fault.text}" for seq, item in enumerate(items) if (fault := self._check(seq, item))
        )
        text = next(faults, "")
        if not text and (fault := self._check_whole(self._arriving)):
            text = fault.text
        if text:
            self.loss = f"{text}; none is in use"
        else:
            self._arrived = tuple(self._arriving)
            self.swap_in()
        self._arriving = []

    def _check(self, seq: int, item: MissionItem) -> ItemFault | None:
        """Check and keep an item on arrival."""
        step: Step | ItemFault = Home()
        if self.type is MissionType.MISSION:
            step = to_step(seq, item, self._fitted)
        else:
            check = check_fence_item if self.type is MissionType.FENCE else check_rally_item
            step = check(item) or step
        if isinstance(step, ItemFault):
            return step
        del self._arriving[seq - self.receiver.first :]
        self._arriving.append(ListEntry(item, step, encode_item(item)))
        return None

    def _check_whole(self, entries: Sequence[ListEntry]) -> ItemFault | None:
        if self.type is MissionType.MISSION:
            return check_jumps([entry.step for entry in entries])
        return check_fence([entry.item for entry in entries]) if self.type is MissionType.FENCE else None


def _home_item(home: LatLon) -> MissionItem:
    x, y = position_to_e7(home)
    return MissionItem(dialect.MAV_FRAME_GLOBAL, dialect.MAV_CMD_NAV_WAYPOINT, x=x, y=y)
