"""One boat as this station knows it: its view, its texts, and what is under way to it."""

from collections.abc import Callable
from typing import Any, Final

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.commands import Commands
from mission_tools.station.ftp.client import FtpClient
from mission_tools.station.items import ItemLists
from mission_tools.station.logs import LogList
from mission_tools.station.messages import Answer, BoatName, PageRequest, Sensor, Snapshot
from mission_tools.station.outcome import Accepted, Answered, Outcome, Refused
from mission_tools.station.parameters.parameter_table import WANTED as PARAMETER_MESSAGES
from mission_tools.station.parameters.parameter_table import ParameterTable
from mission_tools.station.reasons import Reasons
from mission_tools.station.requests import BadRequestError, build_command, way_points
from mission_tools.station.sailing import Sailing
from mission_tools.station.setup.latest_messages import MESSAGES as PARTS
from mission_tools.station.setup.latest_messages import LatestMessages
from mission_tools.station.setup.requests import MESSAGES as SETTING_UP
from mission_tools.station.setup.requests import REQUESTS as SETUP
from mission_tools.station.setup.requests import Setup, why_not_disarmed
from mission_tools.station.setup.sensor_checks import Board, SensorSnapshot
from mission_tools.station.setup.sensors import sensors
from mission_tools.station.streams import Streams
from mission_tools.station.texts import Text, Texts
from mission_tools.station.uploads import Upload, way_upload
from mission_tools.station.view import HANDLERS, SHOWN, View
from mission_tools.station.wire import command_long
from mission_tools.station.words import say

SILENT_S: Final = 5.0  # without a heartbeat: nothing is asked of the boat meanwhile
_OWN_ABSENCE: Final = ("Failsafe: Operator lost", "Failsafe over: operator heard again")
_DEPARTURES: Final = frozenset({"continue", "go", "return", "sail", "start"})
_MISSION_MESSAGES: Final = frozenset(
    {
        dialect.MAVLINK_MSG_ID_MISSION_ACK,
        dialect.MAVLINK_MSG_ID_MISSION_COUNT,
        dialect.MAVLINK_MSG_ID_MISSION_ITEM_INT,
        dialect.MAVLINK_MSG_ID_MISSION_REQUEST,
        dialect.MAVLINK_MSG_ID_MISSION_REQUEST_INT,
    }
)
_IN_SHORT: Final = ("mode", "armed", "state", "place", "heading_deg")  # of the view, as in the list of boats
_RESTARTED_MS: Final = 5_000  # the boat's clock goes back by more than messages overtake each other
WANTED: Final = _MISSION_MESSAGES | PARTS | PARAMETER_MESSAGES | SETTING_UP | HANDLERS.keys() | {
    dialect.MAVLINK_MSG_ID_COMMAND_ACK, dialect.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL,
    dialect.MAVLINK_MSG_ID_LOG_ENTRY, dialect.MAVLINK_MSG_ID_STATUSTEXT,
}  # fmt: skip


class ShoreBoat:
    """A boat. send: a message on the link on which the boat was last heard."""

    def __init__(self, address: Address, own: Address, send: Callable[[Message], None]) -> None:
        self.address = address
        self.heard_s: float | None = None  # Unix time of the latest heartbeat
        self.view = View()
        self.lists = ItemLists(address, own, send)
        self.files = FtpClient(address, own, send)
        self.logs = LogList(address, send, self.files)
        self.texts = Texts(self._is_news)
        self.reasons = Reasons()
        self._send = send
        self._commands = Commands(address, own, send)
        self._sailing = Sailing(address, own, send, self._commands.ask, self.lists)
        self._streams = Streams(address, send)
        self.parameters = ParameterTable(address, own, send, self.files.read_whole)
        self._heartbeat_s = float("-inf")
        self._total: int | None = None
        self._parts = LatestMessages()
        self._boot_ms = 0
        self._setup = Setup(address, own, send)

    def relink(self) -> None:
        """The boat is heard on another link, which has none of the streams asked for."""
        self._streams.restart()

    def handle(self, message: Message, now_s: float, unix_s: float) -> None:
        """A message of this boat's autopilot, one of WANTED."""
        number = message.get_msgId()
        self._streams.on_message(number)
        if (handler := HANDLERS.get(number)) is not None:
            starts = self.view.starts
            handler(self.view, message)
            if self.view.starts > starts:  # the new program has none of the streams asked for
                self._streams.restart()
        if number in PARTS:
            self._parts.on_message(message, now_s)
        if number in SETTING_UP:
            self._setup.handle(message, now_s)
        if number == dialect.MAVLINK_MSG_ID_HEARTBEAT:
            self.heard_s, self._heartbeat_s = unix_s, now_s
            self.parameters.on_autopilot(message.autopilot)
        elif number == dialect.MAVLINK_MSG_ID_GLOBAL_POSITION_INT:
            self._note_boot(message.time_boot_ms)
        elif number == dialect.MAVLINK_MSG_ID_MISSION_CURRENT:
            self.lists.on_ids((message.mission_id, message.fence_id, message.rally_points_id), now_s)
            if self.view.mission_total != self._total:
                self._total = self.view.mission_total
                self.lists.may_have_changed("mission", now_s)
        elif number == dialect.MAVLINK_MSG_ID_COMMAND_ACK:
            self._commands.on_ack(message, now_s)
        elif number == dialect.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL:
            self.files.handle(message, now_s)
        elif number == dialect.MAVLINK_MSG_ID_LOG_ENTRY:
            self.logs.handle(message)
        elif number == dialect.MAVLINK_MSG_ID_STATUSTEXT:
            for text in self.texts.ingest(message, now_s, unix_s):
                self._on_text(text, now_s)
        elif number in PARAMETER_MESSAGES:
            self.parameters.handle(message, now_s)
        elif number in _MISSION_MESSAGES:
            self.lists.handle(message, now_s)
            self._sailing.handle(message, now_s)

    def _is_news(self, text: Text) -> bool:
        """That the operator of a disarmed boat has gone and come back, they know themselves."""
        return self.view.armed is not False or not text.text.startswith(_OWN_ABSENCE)

    def _on_text(self, text: Text, now_s: float) -> None:
        self._commands.on_text(text)
        self._setup.on_text(text, now_s)
        self.parameters.on_text(text.text, now_s)
        self.reasons.on_text(text, now_s)

    def _note_boot(self, boot_ms: int) -> None:
        if boot_ms + _RESTARTED_MS < self._boot_ms:
            self.parameters.restart()
        self._boot_ms = boot_ms

    def poll(self, now_s: float, unix_s: float) -> None:
        """Repeat, give up, and ask for what is missing."""
        view = self.view
        for text in self.texts.poll(now_s, unix_s):
            self._on_text(text, now_s)
        self._commands.poll(now_s)
        self._setup.poll(now_s, view.armed)
        self.files.poll(now_s)
        self.logs.poll(now_s)
        self._sailing.poll(now_s)
        is_heard = self.silent_s(now_s) < SILENT_S
        self.parameters.poll(now_s, is_heard)
        if not self._sailing.is_uploading:
            self.lists.poll(now_s, is_heard)
        if not is_heard:
            return
        has_modes = view.mode_count is not None and len(view.mode_names) >= view.mode_count
        self._streams.poll(now_s, has_modes=has_modes, has_cruise=view.cruise_m_s is not None)
        if self.reasons.poll(view, now_s):
            self._send(command_long(self.address, dialect.MAV_CMD_RUN_PREARM_CHECKS))

    def ask(self, request: PageRequest, answer: Callable[[Answer], None], now_s: float) -> None:
        """Do what the page asks; exactly one answer."""
        view = self.view

        def answered(outcome: Outcome, result: dict[str, Any] | None = None) -> None:
            is_done, text = isinstance(outcome, Accepted), outcome.text
            if is_done and request.what in _DEPARTURES and view.armed is False:
                text = say("answer.when_armed", what=text)
            answer(Answer(id=request.id, ok=is_done, text=text, result=result))

        armed = view.armed if self.silent_s(now_s) < SILENT_S else None  # not heard: it may be armed since
        if request.what == "set_parameter":
            self.parameters.set(request.arguments, armed, answered, now_s)
            return
        try:
            if request.what in SETUP:
                self._setup.ask(request.what, request.arguments, answered, armed, now_s)
                return
            self._setup.motors.end_press()
            if request.what == "sail":
                self.upload(way_upload(way_points(request.arguments)), answered, now_s)
                return
            command = build_command(request.what, request.arguments, self._mode_numbers())
        except BadRequestError as error:
            answered(Refused(error.args[0]))
            return
        if command.disarmed and armed is not False:
            answered(Refused(why_not_disarmed(armed)))
            return
        if command.steers:
            self._sailing.cancel(now_s)
        self._commands.ask(command, answered, now_s)

    def sensors(self, board: Board, now_s: float) -> list[Sensor]:
        """The parts with their values and verdicts; asks the boat for them for the next WANTED_S.

        board: fields of the server's own computer, if the boat runs there.
        """
        self._streams.want_sensors(now_s)
        is_heard = self.silent_s(now_s) < SILENT_S
        return sensors(SensorSnapshot(self._parts, self.view, self.reasons.now(), now_s, is_heard, board))

    @property
    def is_transferring(self) -> bool:
        """Whether a list is on its way, either way."""
        return self._sailing.is_active or self.lists.is_reading

    def silent_s(self, now_s: float) -> float:
        """How long ago its latest heartbeat was heard."""
        return now_s - self._heartbeat_s

    def upload(self, upload: Upload, answered: Answered, now_s: float) -> None:
        """Give the boat lists of items; one answer, within the upload's limit and a start."""
        if upload.start is not None:
            self._commands.replace_steering()
        self.lists.pause(now_s)
        self._sailing.ask(upload, answered, now_s)

    def in_short(self, unix_s: float) -> BoatName:
        """The boat's line in the list of boats."""
        view = self.view
        return BoatName(
            id=self.address.system,
            heard_s=self.heard_s,
            age_s=None if self.heard_s is None else round(max(unix_s - self.heard_s, 0.0), 1),
            percent=None if view.battery is None else view.battery.percent,
            left_s=None if view.battery is None else view.battery.left_s,
            **{name: getattr(view, name) for name in _IN_SHORT},
        )

    def snapshot(self) -> Snapshot:
        """The boat as the page shows it; without links, temperature and disk."""
        return Snapshot(
            boat=self.address.system,
            heard_s=self.heard_s,
            modes=list(self._mode_numbers()),
            compass=self.view.compass(),
            home=self.view.way_home(),
            mission=self.lists.summary("mission"),
            fence=self.lists.summary("fence"),
            rally=self.lists.summary("rally"),
            calibration=self._setup.calibrations.latest,
            reasons=self.reasons.now(),
            lines=list(self.texts.lines),
            **{name: getattr(self.view, name) for name in SHOWN},
        )

    def _mode_numbers(self) -> dict[str, int]:
        return {name: number for number, name in self.view.mode_names.items()}
