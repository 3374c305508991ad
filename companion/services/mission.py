"""The mission protocol for mission, fence and rally: uploads, downloads, clearing, the current item.

One upload of a kind runs at a time, whoever sends it; downloads run side by side, one a channel. A list
that has come whole is written to disk, then swapped in, then acknowledged.
"""

import logging
from typing import NamedTuple

from companion.config import BoatConfig
from companion.geo import LatLon
from companion.mavlink.address import Address, is_named
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import Fault, MissionItem, MissionResult, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed, Failed, State, Transfer
from companion.requests import GoTo, SetCurrentItem
from companion.services.mission_items import check_jumps, to_step
from companion.services.mission_store import load_items, save_items
from companion.services.outbox import Origin, Outbox
from companion.services.status_messages import mission_current
from companion.services.statustext import StatusTextService
from companion.storage import Saving, Storage
from companion.vehicle.mission_steps import Mission, Step
from companion.vehicle.notice import Notice, Severity
from companion.vehicle.vehicle import Vehicle

logger = logging.getLogger(__name__)

_ALL_TYPES = dialect.MAV_MISSION_TYPE_ALL
_ITEM = frozenset({"MISSION_ITEM_INT", "MISSION_ITEM"})
_UPLOAD = frozenset({"MISSION_COUNT", "MISSION_CLEAR_ALL"}) | _ITEM
_DOWNLOAD = frozenset({"MISSION_REQUEST_LIST", "MISSION_REQUEST_INT", "MISSION_REQUEST"})
_GUIDED_ITEM, _ALTITUDE_ITEM = 2, 3  # MISSION_ITEM.current of ArduPilot's old go-to and change of altitude


class _List:
    """One of the boat's lists: what it holds, what is arriving, what is being written."""

    def __init__(self, own: Address, mission_type: MissionType, config: BoatConfig, storage: Storage) -> None:
        self.type = mission_type
        self.items = load_items(storage, mission_type)
        limits, timers = config.mission, config.mavlink
        most = {
            MissionType.MISSION: limits.max_items,
            MissionType.FENCE: limits.max_fence_items,
            MissionType.RALLY: limits.max_rally_items,
        }[mission_type]
        check = _check_mission_item if mission_type is MissionType.MISSION else _check_area_item
        self.receiver = Receiver(own, mission_type, timers.retry_s, timers.retries, most, check)
        self.upload_channel = 0
        self.senders: dict[int, Sender] = {}
        self.saving: Saving | None = None
        self.arrived: tuple[MissionItem, ...] = ()


class _Clearing(NamedTuple):
    """All lists are being emptied on the medium, for one station."""

    origin: Origin
    savings: list[Saving]


class MissionService:
    """Owns the three lists and keeps the vehicle's mission in step with the first."""

    def __init__(
        self,
        own: Address,
        vehicle: Vehicle,
        config: BoatConfig,
        storage: Storage,
        outbox: Outbox,
        texts: StatusTextService,
    ) -> None:
        self._own = own
        self._vehicle = vehicle
        self._timers = config.mavlink
        self._storage = storage
        self._outbox = outbox
        self._texts = texts
        self._clearing: _Clearing | None = None
        self._current_said = 0
        self._lists = {kind: _List(own, kind, config, storage) for kind in MissionType}
        mission = _to_mission(self._lists[MissionType.MISSION].items)
        if isinstance(mission, Fault):
            logger.warning("the stored mission is not sailed: %s", mission.text)
        else:
            vehicle.take_mission(mission)

    def items(self, mission_type: MissionType) -> tuple[MissionItem, ...]:
        """What the boat holds of a kind."""
        return self._lists[mission_type].items

    def handle(self, message: Message, origin: Origin, now_s: float) -> None:
        """Take one message of the protocol."""
        if not is_named(self._own, message.target_system, message.target_component):
            return  # a list offered to every boat within reach is offered to none
        name = message.get_type()
        if name == "MISSION_SET_CURRENT":
            self._vehicle.request(SetCurrentItem(message.seq))
            self._tell_current()
            return
        if name in _ITEM and message.current in (_GUIDED_ITEM, _ALTITUDE_ITEM):
            self._on_guided_item(message, origin)
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
        if name in _DOWNLOAD or name == "MISSION_ACK":
            sender = self._sender(one, origin.channel)
            sender.handle(message, origin.address, now_s)
            self._post(sender, origin.channel)

    def tick(self, now_s: float) -> None:
        """Retries, time-outs, and lists whose writing has ended."""
        if self._clearing is not None:
            self._finish_clearing(self._clearing)
        for one in self._lists.values():
            if one.saving is not None:
                self._finish_saving(one, now_s)
            if one.receiver.state is not State.IDLE:
                one.receiver.tick(now_s)
                self._after_receiver(one, now_s)
            for channel, sender in one.senders.items():
                if sender.state is not State.IDLE:
                    sender.tick(now_s)
                    self._post(sender, channel)
        for seq in self._vehicle.progress.take_reached():
            self._outbox.broadcast(dialect.MAVLink_mission_item_reached_message(seq))
        if self._vehicle.progress.current_seq != self._current_said:
            self._tell_current()

    def forget(self, channel: int, now_s: float) -> None:
        """A channel has gone: an upload on it has broken off, and others need not wait for its time-out."""
        for one in self._lists.values():
            one.senders.pop(channel, None)
            if one.upload_channel == channel:
                one.receiver.cancel(now_s)
                self._after_receiver(one, now_s)

    def _tell_current(self) -> None:
        self._current_said = self._vehicle.progress.current_seq
        self._outbox.broadcast(mission_current(self._vehicle))

    def _receive(self, one: _List, message: Message, origin: Origin, now_s: float) -> None:
        # Two stations may well have the same ids: the channel tells them apart
        busy = one.receiver.partner is not None and one.upload_channel != origin.channel
        if busy or self._clearing is not None:
            if message.get_type() in ("MISSION_COUNT", "MISSION_CLEAR_ALL"):
                self._acknowledge(origin, MissionResult.DENIED, one.type)
            return
        one.upload_channel = origin.channel
        one.receiver.handle(message, origin.address, now_s)
        self._after_receiver(one, now_s)

    def _after_receiver(self, one: _List, now_s: float) -> None:
        for event in one.receiver.take_events():
            if isinstance(event, Completed):
                self._store(one, event.items, now_s)
            elif isinstance(event, Failed):
                text = f"{one.type.name.capitalize()} upload failed: {event.text}"
                self._texts.tell([Notice(Severity.WARNING, text)])
        self._post(one.receiver, one.upload_channel)

    def _store(self, one: _List, items: tuple[MissionItem, ...], now_s: float) -> None:
        fault = _to_mission(items) if one.type is MissionType.MISSION else None
        if isinstance(fault, Fault):
            one.receiver.confirm(now_s, fault.result)
            self._texts.tell([Notice(Severity.WARNING, f"Mission refused: {fault.text}")])
            return
        one.arrived = items
        one.saving = save_items(self._storage, one.type, items)
        self._finish_saving(one, now_s)

    def _finish_saving(self, one: _List, now_s: float) -> None:
        saving = one.saving
        if saving is None or not saving.is_done():
            return
        one.saving = None
        if error := saving.error():
            one.receiver.confirm(now_s, MissionResult.ERROR)
            self._tell_not_stored(one, error)
        else:
            self._swap_in(one, one.arrived)
            one.receiver.confirm(now_s)
        one.arrived = ()
        self._post(one.receiver, one.upload_channel)

    def _swap_in(self, one: _List, items: tuple[MissionItem, ...]) -> None:
        one.items = items
        if one.type is MissionType.MISSION:
            mission = _to_mission(items)
            self._vehicle.take_mission(() if isinstance(mission, Fault) else mission)
        elif items:
            text = f"{one.type.name.capitalize()} stored, but this boat does not act on it yet"
            self._texts.tell([Notice(Severity.WARNING, text)])

    def _clear_all(self, origin: Origin) -> None:
        if self._clearing is not None or any(one.receiver.partner for one in self._lists.values()):
            self._acknowledge(origin, MissionResult.DENIED, _ALL_TYPES)
            return
        savings = [save_items(self._storage, kind, ()) for kind in self._lists]
        self._clearing = _Clearing(origin, savings)
        self._finish_clearing(self._clearing)

    def _finish_clearing(self, clearing: _Clearing) -> None:
        if not all(saving.is_done() for saving in clearing.savings):
            return
        self._clearing = None
        result = MissionResult.ACCEPTED
        for one, saving in zip(self._lists.values(), clearing.savings, strict=True):
            if error := saving.error():
                result = MissionResult.ERROR
                self._tell_not_stored(one, error)
            else:
                self._swap_in(one, ())
        self._acknowledge(clearing.origin, result, _ALL_TYPES)

    def _tell_not_stored(self, one: _List, error: str) -> None:
        self._texts.tell([Notice(Severity.ERROR, f"{one.type.name.capitalize()} not stored: {error}")])

    def _sender(self, one: _List, channel: int) -> Sender:
        if channel not in one.senders:
            one.senders[channel] = Sender(
                self._own, one.type, self._timers.retry_s, self._timers.retries, source=lambda: one.items
            )
        return one.senders[channel]

    def _post(self, machine: Transfer, channel: int) -> None:
        for message in machine.take_outbox():
            self._outbox.send(channel, message)
        if isinstance(machine, Sender):
            machine.take_events()  # a download that fails is the station's affair

    def _on_guided_item(self, message: Message, origin: Origin) -> None:
        """QGroundControl's first go-to still comes as an item of no list, with current = 2."""
        result = MissionResult.ACCEPTED
        if message.current == _GUIDED_ITEM:
            item = MissionItem.from_message(message)
            step = item if isinstance(item, Fault) else to_step(1, item)
            position = getattr(step, "position", None)
            if not isinstance(position, LatLon):
                result = step.result if isinstance(step, Fault) else MissionResult.UNSUPPORTED
            elif not self._vehicle.request(GoTo(position)).accepted:
                result = MissionResult.ERROR
        self._acknowledge(origin, result, MissionType.MISSION)

    def _acknowledge(self, origin: Origin, result: MissionResult, mission_type: int) -> None:
        address = origin.address
        self._outbox.send(
            origin.channel,
            dialect.MAVLink_mission_ack_message(address.system, address.component, result, mission_type),
        )


def _check_mission_item(seq: int, item: MissionItem) -> Fault | None:
    step = to_step(seq, item)
    return step if isinstance(step, Fault) else None


def _check_area_item(seq: int, item: MissionItem) -> Fault | None:  # noqa: ARG001
    """Fence and rally: a place on the globe, whatever the command says of it."""
    if abs(item.x) > 900_000_000 or abs(item.y) > 1_800_000_000:
        return Fault(MissionResult.INVALID_PARAM5_X, f"{item.x}, {item.y} is no place on the globe")
    return None


def _to_mission(items: tuple[MissionItem, ...]) -> Mission | Fault:
    steps: list[Step] = []
    for seq, item in enumerate(items):
        step = to_step(seq, item)
        if isinstance(step, Fault):
            return step
        steps.append(step)
    return check_jumps(steps) or tuple(steps)
