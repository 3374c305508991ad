"""The mission protocol for mission, fence and rally: uploads, downloads, clearing, current item.

One upload per list at a time, from any station; downloads run in parallel, one per channel. An uploaded list,
or part of one, is stored, then used, then acknowledged.
"""

import logging
from dataclasses import InitVar, dataclass, field

from companion.config.boat_config import BoatConfig
from companion.core.requests import SetCurrentItem
from companion.core.status_text import Severity
from companion.core.storage import Saving, Storage
from companion.mavlink.address import Address, is_named
from companion.mavlink.dialect import Message, dialect, message_ids
from companion.mavlink.items import MissionItem, MissionResult, MissionType
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed, Failed, Transfer, TransferState
from companion.payload.fitted import FittedPayload
from companion.services.missions.area_items import fence_areas, rally_points
from companion.services.missions.guided_item import on_guided_item
from companion.services.missions.items import SAILED_STRAIGHT, command_name
from companion.services.missions.list import MissionList, Part
from companion.services.outbox import Origin, Outbox
from companion.services.statustext import StatusTextService
from companion.services.telemetry.status_messages import mission_current
from companion.vehicle.mission.steps import Skip
from companion.vehicle.vehicle import Vehicle

logger = logging.getLogger(__name__)

_ALL_TYPES = dialect.MAV_MISSION_TYPE_ALL
_ITEM = frozenset({"MISSION_ITEM_INT", "MISSION_ITEM"})
_OFFERS = frozenset({"MISSION_COUNT", "MISSION_CLEAR_ALL", "MISSION_WRITE_PARTIAL_LIST"})
_UPLOAD = _OFFERS | _ITEM
_DOWNLOAD = frozenset({"MISSION_REQUEST_LIST", "MISSION_REQUEST_INT", "MISSION_REQUEST"})
MISSION_MESSAGES = message_ids(
    *sorted(_UPLOAD | _DOWNLOAD), "MISSION_ACK", "MISSION_SET_CURRENT", "MISSION_REQUEST_PARTIAL_LIST"
)
_LIST_ITEM = 1  # MISSION_ITEM.current above it: ArduPilot's old go-to, an item of no list
_PART_PER_TICK = 10
_ITEM_BYTES = 50  # on the line
_NAMES = {MissionType.MISSION: "mission", MissionType.FENCE: "fence", MissionType.RALLY: "rally points"}


@dataclass(eq=False)
class MissionService:
    """Owns the three lists and updates the vehicle."""

    _own: Address
    _vehicle: Vehicle
    config: InitVar[BoatConfig]
    storage: InitVar[Storage]
    _outbox: Outbox
    _texts: StatusTextService
    fitted: InitVar[FittedPayload]
    _clearing: tuple[Origin, list[Saving]] | None = field(default=None, init=False)  # of all lists
    _reported_seq: int = field(default=0, init=False)

    def __post_init__(self, config: BoatConfig, storage: Storage, fitted: FittedPayload) -> None:
        vehicle = self._vehicle
        self._lists = {kind: MissionList(self._own, kind, config, storage, fitted) for kind in MissionType}
        for one in self._lists.values():
            if one.loss:
                name = one.type.name.lower()
                logger.warning("the stored %s is lost: %s", name, one.loss)
                vehicle.data_losses.add(name, one.loss, f"Upload or clear the {_NAMES[one.type]}")
        self._lists[MissionType.MISSION].home = lambda: vehicle.home
        vehicle.set_mission(self._lists[MissionType.MISSION].steps)
        vehicle.set_fence(fence_areas(self.items(MissionType.FENCE)))
        vehicle.set_rally(rally_points(self.items(MissionType.RALLY)))
        self._identify()

    def items(self, mission_type: MissionType) -> tuple[MissionItem, ...]:
        return self._lists[mission_type].items

    @property
    def is_busy(self) -> bool:
        return self._clearing is not None or not all(one.is_idle for one in self._lists.values())

    def handle(self, message: Message, origin: Origin, now_s: float) -> None:
        if not is_named(self._own, message.target_system, message.target_component):
            return  # broadcast transfers are ignored
        for one in self._lists.values():
            if one.upload_channel == origin.channel:
                one.receiver.rest(origin.address)
        name = message.get_type()
        if name == "MISSION_SET_CURRENT":
            self._vehicle.request(SetCurrentItem(message.seq))
            self._send_current()
            return
        if name in _ITEM and message.current > _LIST_ITEM:
            self._acknowledge(origin, on_guided_item(message, self._vehicle), MissionType.MISSION)
            return
        if name == "MISSION_CLEAR_ALL" and message.mission_type == _ALL_TYPES:
            self._clear_all(origin)
            return
        if message.mission_type not in self._lists:
            self._acknowledge(origin, MissionResult.UNSUPPORTED, message.mission_type)
            return
        one = self._lists[MissionType(message.mission_type)]
        if name in _UPLOAD or (name == "MISSION_ACK" and one.upload_channel == origin.channel):
            self._receive(one, message, origin, now_s)
        if name == "MISSION_REQUEST_PARTIAL_LIST":
            self._request_part(one, message, origin)
        elif name in _DOWNLOAD or name == "MISSION_ACK":
            sender = one.sender(origin.channel)
            sender.handle(message, origin.address, now_s)
            self._post(sender, origin.channel)

    def tick(self, now_s: float) -> None:
        """Retries, time-outs and finished saves."""
        if self._clearing is not None:
            self._finish_clearing(*self._clearing)
        for one in self._lists.values():
            if not one.is_idle:
                self._tick_list(one, now_s)
        progress = self._vehicle.progress
        for seq in progress.take_reached():
            self._outbox.broadcast(dialect.MAVLink_mission_item_reached_message(seq))
        if progress.current_seq != self._reported_seq:
            self._send_current()

    def _tick_list(self, one: MissionList, now_s: float) -> None:
        if one.saving is not None:
            self._finish_saving(one, now_s)
        if one.receiver.state is not TransferState.IDLE:
            one.receiver.tick(now_s)
            self._after_receiver(one, now_s)
        for channel, sender in list(one.senders.items()):
            sender.tick(now_s)
            self._post(sender, channel)
            if sender.state is TransferState.IDLE:
                del one.senders[channel]
        if one.parts:
            self._send_parts(one)

    def forget(self, channel: int, now_s: float) -> None:
        """A channel has closed: cancel its transfers."""
        for one in self._lists.values():
            one.senders.pop(channel, None)
            one.parts.pop(channel, None)
            if one.upload_channel == channel:
                one.receiver.cancel(now_s)
                self._after_receiver(one, now_s)

    def _send_current(self) -> None:
        self._reported_seq = self._vehicle.progress.current_seq
        self._outbox.broadcast(mission_current(self._vehicle))

    def _receive(self, one: MissionList, message: Message, origin: Origin, now_s: float) -> None:
        # Two stations may have the same ids: compare the channel
        busy = one.receiver.partner is not None and one.upload_channel != origin.channel
        if busy or self._clearing is not None:
            if message.get_type() in _OFFERS:
                self._acknowledge(origin, MissionResult.DENIED, one.type)
            return
        one.upload_channel = origin.channel
        if message.get_type() == "MISSION_WRITE_PARTIAL_LIST":
            self._receive_part(one, message, origin, now_s)
        else:
            one.receiver.handle(message, origin.address, now_s)
        self._after_receiver(one, now_s)

    def _receive_part(self, one: MissionList, message: Message, origin: Origin, now_s: float) -> None:
        """A part may start at any stored item or right after the last, and may extend the list."""
        first, last = message.start_index, message.end_index
        if not 0 <= first <= min(last, len(one.entries)):
            self._acknowledge(origin, MissionResult.INVALID_SEQUENCE, one.type)
        elif last >= one.most:
            self._acknowledge(origin, MissionResult.NO_SPACE, one.type)
        else:
            one.receiver.take_part(first, last - first + 1, origin.address, now_s)

    def _after_receiver(self, one: MissionList, now_s: float) -> None:
        for event in one.receiver.take_events():
            if isinstance(event, Completed):
                self._store(one, event, now_s)
            elif isinstance(event, Failed):
                self._texts.notify(Severity.WARNING, f"{_title(one)} upload failed: {event.text}")
        self._post(one.receiver, one.upload_channel)

    def _store(self, one: MissionList, completed: Completed, now_s: float) -> None:
        fault = one.store(completed)
        if fault is not None:
            one.receiver.confirm(now_s, fault.result)
            self._texts.notify(Severity.WARNING, f"{_title(one)} refused: {fault.text}")
            return
        self._finish_saving(one, now_s)

    def _finish_saving(self, one: MissionList, now_s: float) -> None:
        saving = one.saving
        if saving is None or not saving.is_done():
            return
        one.saving = None
        if error := saving.error():
            one.drop()
            one.receiver.confirm(now_s, MissionResult.ERROR)
            self._report_not_stored(one, error)
        else:
            self._swap_in(one)
            one.receiver.confirm(now_s)
        self._post(one.receiver, one.upload_channel)

    def _swap_in(self, one: MissionList) -> None:
        one.swap_in()
        self._identify()
        self._vehicle.data_losses.end(one.type.name.lower())
        if one.type is MissionType.FENCE:
            self._vehicle.set_fence(fence_areas(one.items))
            return
        if one.type is MissionType.RALLY:
            self._vehicle.set_rally(rally_points(one.items))
            return
        self._vehicle.set_mission(one.steps)
        self._warn_of(one, [seq for seq, step in enumerate(one.steps) if type(step) is Skip], "is ignored")
        curved = [seq for seq, item in enumerate(one.items) if seq and item.command in SAILED_STRAIGHT]
        self._warn_of(one, curved, "is sailed without its curve")

    def _identify(self) -> None:
        mission, fence, rally = (self._lists[kind].id for kind in MissionType)
        self._vehicle.list_ids = mission, fence, rally

    def _warn_of(self, one: MissionList, seqs: list[int], what: str) -> None:
        """One text for all items that are not sailed as drawn."""
        if seqs:
            command = command_name(one.entries[seqs[0]].item.command)
            more = f", and {len(seqs) - 1} more" if len(seqs) > 1 else ""
            self._texts.notify(Severity.WARNING, f"Mission: item {seqs[0]}, {command}, {what}{more}")

    def _clear_all(self, origin: Origin) -> None:
        if self._clearing is not None or any(one.receiver.partner for one in self._lists.values()):
            self._acknowledge(origin, MissionResult.DENIED, _ALL_TYPES)
            return
        self._clearing = origin, [one.clear() for one in self._lists.values()]
        self._finish_clearing(*self._clearing)

    def _finish_clearing(self, origin: Origin, savings: list[Saving]) -> None:
        if not all(saving.is_done() for saving in savings):
            return
        self._clearing = None
        result = MissionResult.ACCEPTED
        for one, saving in zip(self._lists.values(), savings, strict=True):
            if error := saving.error():
                result = MissionResult.ERROR
                self._report_not_stored(one, error)
            else:
                self._swap_in(one)
        self._acknowledge(origin, result, _ALL_TYPES)

    def _request_part(self, one: MissionList, message: Message, origin: Origin) -> None:
        """Send items, a few a tick, unacknowledged: stations ask for lost ones. End −1: the last item."""
        held = len(one.entries)
        first = message.start_index
        last = held - 1 if message.end_index == -1 else message.end_index
        if not 0 <= first <= last < held:
            self._acknowledge(origin, MissionResult.INVALID_SEQUENCE, one.type)
            return
        one.parts[origin.channel] = Part(origin.address, first, last)

    def _send_parts(self, one: MissionList) -> None:
        items = one.offered()
        for channel, part in list(one.parts.items()):
            seq = part.next_seq
            for _ in range(_PART_PER_TICK):
                if seq > min(part.last_seq, len(one.entries) - 1) or not self._outbox.has_room(channel):
                    break
                message = items[seq].to_message(seq, part.partner, one.type)
                self._outbox.send_bulk(channel, message, _ITEM_BYTES)
                seq += 1
            if seq > min(part.last_seq, len(one.entries) - 1):
                del one.parts[channel]
            else:
                one.parts[channel] = part._replace(next_seq=seq)

    def _post(self, machine: Transfer, channel: int) -> None:
        for message in machine.take_outbox():
            self._outbox.send(channel, message)
        if isinstance(machine, Sender):
            machine.take_events()  # failed downloads are not reported

    def _acknowledge(self, origin: Origin, result: MissionResult, mission_type: int) -> None:
        answer = dialect.MAVLink_mission_ack_message(*origin.address, result, mission_type)
        self._outbox.send(origin.channel, answer)

    def _report_not_stored(self, one: MissionList, error: str) -> None:
        self._texts.notify(Severity.ERROR, f"{_title(one)} not stored: {error}")


def _title(one: MissionList) -> str:
    return one.type.name.capitalize()
