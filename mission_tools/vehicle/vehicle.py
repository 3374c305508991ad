"""Any MAVLink vehicle, over MAVSDK: upload, read back, clear, arm, start, watch. `connection.py` finds it."""

import asyncio
import contextlib
import json
import logging
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping, Sequence

from mavsdk.asyncio import System
from mavsdk.asyncio.plugins.mavlink_direct import MavlinkDirectAsync
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.plugins.mavlink_direct import MavlinkDirectError, MavlinkMessage
from mavsdk.plugins.mission_raw import MissionItem as RawItem
from mavsdk.plugins.mission_raw import MissionRawError, MissionRawResult

from mission_tools.errors import CommandRefused, LinkLost, UploadRejected
from mission_tools.mission.mission import LIST_NAMES, Command, MissionItem, MissionType
from mission_tools.vehicle.link_url import LinkUrl
from mission_tools.vehicle.state import (
    AUTO,
    AUTOPILOT_COMPONENT,
    COMMAND_RESULTS,
    MISSION_REFUSALS,
    VehicleState,
)

SILENCE_S = 5.0  # without a heartbeat the link counts as lost
TEXT_DELAY_S = 0.3  # a refusal's reason may come after the refusal
RETRY_S = 1.0
CLEAR_TRIES = 5
# MAVSDK gives up after 2.5 s without an answer, and TCP on a bad wire stops for as long
TRANSFER_TRIES = 3
TRY_PAUSE_S = 3.0  # until the line has brought what belongs to the try before
ASKED_RATES_HZ = {33: 4.0, 42: 2.0}  # GLOBAL_POSITION_INT, MISSION_CURRENT

Transfer = Callable[[], Awaitable[list[RawItem] | None]]

log = logging.getLogger(__name__)


class Vehicle:
    """One vehicle on one link. Made by `connection.connect`."""

    def __init__(self, link: LinkUrl, system: System, system_id: int, clock: Callable[[], float]) -> None:
        self.link = link
        self.system_id = system_id
        self.state = VehicleState()
        self.notify: Callable[[str], object] = log.info  # tells what is tried again
        self._clock = clock
        self._missions = MissionRawAsync(system)
        self._direct = MavlinkDirectAsync(system)

    @property
    def is_lost(self) -> bool:
        """Whether no heartbeat has come for SILENCE_S."""
        return self._clock() - self.state.heard_s > SILENCE_S

    def raise_if_lost(self, doing: str) -> None:
        """Raises LinkLost: the vehicle has fallen silent; `doing` says in the middle of what."""
        if self.is_lost:
            raise LinkLost(
                f"{self.link.typed}: lost the vehicle while {doing}: no heartbeat for {SILENCE_S:.0f} s"
            )

    async def upload(self, kind: MissionType, items: Sequence[MissionItem]) -> None:
        """Replace one of the vehicle's lists. Raises UploadRejected: the vehicle refused; says which list,
        why and at which item. LinkLost: the vehicle stopped answering.
        """
        raw = [_raw_item(seq, item, kind) for seq, item in enumerate(items)]
        upload = {
            MissionType.MISSION: self._missions.upload_mission,
            MissionType.FENCE: self._missions.upload_geofence,
            MissionType.RALLY: self._missions.upload_rally_points,
        }[kind]
        await self._transfer(f"uploading the {LIST_NAMES[kind]}", lambda: upload(raw))

    async def download(self, kind: MissionType) -> tuple[MissionItem, ...]:
        """One of the lists that the vehicle holds. Raises UploadRejected: the vehicle does not hand it out.
        LinkLost: the vehicle stopped answering.
        """
        download = {
            MissionType.MISSION: self._missions.download_mission,
            MissionType.FENCE: self._missions.download_geofence,
            MissionType.RALLY: self._missions.download_rallypoints,
        }[kind]
        return tuple(map(_item, await self._transfer(f"reading back the {LIST_NAMES[kind]}", download)))

    async def clear(self, kind: MissionType) -> None:
        """Empty one of the vehicle's lists: MAVSDK uploads no empty ones. Raises UploadRejected: the vehicle
        refused. LinkLost: no answer.
        """
        began_s, answers = self._clock(), self.state.answers
        answers.pop(kind, None)
        fields = {"target_system": self.system_id, "target_component": 1, "mission_type": int(kind)}
        message = MavlinkMessage("MISSION_CLEAR_ALL", 0, 0, self.system_id, 1, json.dumps(fields))
        for _ in range(CLEAR_TRIES):
            await self._direct.send_message(message)
            if await self.wait_for(lambda: kind in answers, RETRY_S):
                break
        else:
            where = f"clearing the {LIST_NAMES[kind]}{self._advice(began_s)}"
            raise LinkLost(f"{self.link.typed}: the vehicle stopped answering while {where}")
        if answers[kind]:
            raise UploadRejected(
                f"clearing the {LIST_NAMES[kind]}: the vehicle refused: {_refusal(answers[kind])}"
            )

    async def _transfer(self, doing: str, transfer: Transfer) -> list[RawItem]:
        """Run one MAVSDK transfer, again if only answers are missing. Its failures are told in our words."""
        began_s, self.state.requested_item = self._clock(), -1
        for number in range(1, TRANSFER_TRIES + 1):
            self.state.refused = 0
            try:
                return await transfer() or []
            except MissionRawError as error:
                log.debug("%s: %s", doing, error.result.name)
                result = error.result
            if result is MissionRawResult.NO_MISSION_AVAILABLE:
                return []
            await asyncio.sleep(TEXT_DELAY_S)
            item = f" item {self.state.requested_item}" if self.state.requested_item >= 0 else ""
            if result is not MissionRawResult.TIMEOUT and self.state.has_refused:
                text = self.state.last_warning(began_s)
                reason = _refusal(self.state.refused) + (f" ({text})" if text else "")
                raise UploadRejected(f"{doing}: the vehicle refused{item}: {reason}")
            where = doing + (item and f", after{item}")
            if self.is_lost or not self.state.says_more:
                break  # another try would find the same
            if number < TRANSFER_TRIES:
                self.notify(f"no answer while {where}: trying again")
                await asyncio.sleep(TRY_PAUSE_S)
        where += self._advice(began_s)
        raise LinkLost(f"{self.link.typed}: the vehicle stopped answering while {where}")

    def _advice(self, began_s: float) -> str:
        """What to do about silence, from what the vehicle has said before it."""
        if not self.state.says_more:  # a boat of ours, on a link that asks for signatures
            return (
                ": it sends heartbeats only, as on a link where messages that are not signed are refused; "
                "give the boat's key, --sign-key FILE"
            )
        text = self.state.last_warning(began_s)
        is_tcp = self.link.mavsdk.startswith("tcp")  # where lost packets hold up all that follow
        by_udp = ", or connect by UDP" if is_tcp else ""
        what = f"; bring the vehicle nearer{by_udp}, and try again"
        return f"{what} ({text})" if text else what

    async def start(self, patience_s: float) -> None:
        """Begin the mission from its first item: arm, then MISSION_START.

        A vehicle that is not ready to arm is asked again until patience_s has passed. One that was armed for
        this and then refuses to start is disarmed again. Raises CommandRefused: with the vehicle's reason.
        LinkLost: the vehicle stopped answering.
        """
        with contextlib.suppress(MissionRawError):  # a vehicle without this starts from its first item anyway
            await self._missions.set_current_mission_item(self.state.first_seq)
        was_armed = self.state.armed
        if not was_armed:
            await self._arm(patience_s)
        self.state.reached_item = -1
        try:
            await self._begin(patience_s)
        except CommandRefused:
            if not was_armed:  # do not leave a boat armed that did not start
                with contextlib.suppress(CommandRefused, LinkLost):
                    await self.command(Command.COMPONENT_ARM_DISARM, "disarm", 0.0)
            raise

    async def _arm(self, patience_s: float) -> None:
        began_s = self._clock()
        give_up_s = began_s + patience_s
        while not self.state.armed:
            try:
                await self.command(Command.COMPONENT_ARM_DISARM, "arm", 1.0, reason_since_s=began_s)
                break
            except CommandRefused:
                if self._clock() + RETRY_S > give_up_s:
                    raise
                await asyncio.sleep(RETRY_S)

    async def _begin(self, patience_s: float) -> None:
        await self.command(Command.MISSION_START, "start the mission")
        if not await self.wait_for(self._is_sailing, patience_s):
            self.raise_if_lost("starting the mission")
            raise CommandRefused(f"the vehicle took the start but stays in {self.state.mode}, not AUTO")

    def _is_sailing(self) -> bool:
        return self.state.armed and (self.state.custom_mode == AUTO or not self.state.is_ardupilot)

    async def command(
        self, command: Command, doing: str, *params: float, reason_since_s: float | None = None
    ) -> None:
        """Send a command and wait for its answer. Its reason may stand since an earlier try. Raises
        CommandRefused: with the vehicle's reason, and its text if one came. LinkLost: no answer.
        """
        began_s = self._clock()
        fields = {f"param{number}": 0.0 for number in range(1, 8)}
        fields |= {f"param{number}": value for number, value in enumerate(params, start=1)}
        try:
            ack = await self._direct.send_command(self._command_long(command, fields))
        except MavlinkDirectError:
            advice = self._advice(began_s)
            raise LinkLost(
                f"{self.link.typed}: the vehicle does not answer the request to {doing}{advice}"
            ) from None
        result = json.loads(ack.fields_json)["result"]
        if result != 0:
            await asyncio.sleep(TEXT_DELAY_S)
            text = self.state.refusal(began_s if reason_since_s is None else reason_since_s)
            text = text or COMMAND_RESULTS.get(result, f"MAV_RESULT {result}")
            raise CommandRefused(f"the vehicle refused to {doing}: {text}")

    async def ask_for_rates(self, rates_hz: Mapping[int, float] = ASKED_RATES_HZ) -> None:
        """Ask for messages by their ids. Vehicles that cannot are left to their own rates."""
        for message_id, rate_hz in rates_hz.items():
            fields = {"param1": float(message_id), "param2": 1e6 / rate_hz}
            with contextlib.suppress(MavlinkDirectError):
                await self._direct.send_message(self._command_long(Command.SET_MESSAGE_INTERVAL, fields))

    async def wait_for(self, condition: Callable[[], bool], timeout_s: float) -> bool:
        """Wait until something holds; False when it has not within the time, or the link is lost."""
        give_up_s = self._clock() + timeout_s
        while not condition():
            if self._clock() > give_up_s or self.is_lost:
                return False
            await asyncio.sleep(0.05)
        return True

    def _command_long(self, command: Command, fields: dict[str, float]) -> MavlinkMessage:
        to = {
            "target_system": self.system_id,
            "target_component": 1,
            "command": int(command),
            "confirmation": 0,
        }
        return MavlinkMessage("COMMAND_LONG", 0, 0, self.system_id, 1, json.dumps(to | fields))

    async def watch(self, name: str) -> None:
        """Update the state from one kind of message, forever."""
        async for message in self._direct.subscribe_message(name):
            try:
                fields = json.loads(message.fields_json)
                self.state.handle(name, message.component_id, fields, self._clock())
            except (ValueError, KeyError, TypeError) as error:
                log.debug("%s that makes no sense: %r", name, error)

    async def messages(self, name: str) -> AsyncIterator[str]:
        """The fields of every message of one kind from the autopilot, as JSON."""
        async for message in self._direct.subscribe_message(name):
            if message.component_id == AUTOPILOT_COMPONENT:
                yield message.fields_json

    def close(self) -> None:
        """Let MAVSDK's plugins go."""
        self._missions.destroy()
        self._direct.destroy()


def _raw_item(seq: int, item: MissionItem, kind: MissionType) -> RawItem:
    head = (seq, item.frame, item.command, int(seq == 0), int(item.autocontinue))
    return RawItem(*head, *item.params, item.x, item.y, item.z, int(kind))


def _item(raw: RawItem) -> MissionItem:
    params = (raw.param1, raw.param2, raw.param3, raw.param4)
    return MissionItem(raw.command, raw.frame, params, raw.x, raw.y, raw.z, bool(raw.autocontinue))


def _refusal(result: int) -> str:
    """A MAV_MISSION_RESULT for people."""
    return MISSION_REFUSALS.get(result, f"MAV_MISSION_RESULT {result}")
