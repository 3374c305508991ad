"""A small vehicle over TCP that misbehaves on request. Written on pymavlink, not on our own codec."""

# ruff: noqa: ANN401  (pymavlink has no types)

import contextlib
import math
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from patience import MOMENT_S
from pymavlink.dialects.v20 import all as dialect

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.mission.mission import Mission, MissionItem
from mission_tools.mission.plan_file import save_mission

FRAME = LocalFrame(LatLon(50.0, -1.2))
HOLD, AUTO = 4, 10
METRES_PER_E7 = 0.0111319
TICK_S = 0.05
SIGNING_EPOCH_S = 1420070400


@dataclass
class Behaviour:
    """What goes wrong. Sequence numbers count from home = 0; None: it does not happen."""

    autopilot: int = dialect.MAV_AUTOPILOT_ARDUPILOTMEGA
    at_e7: tuple[int, int] = (500000000, -12000000)
    speed_m_s: float = 100.0
    silent: bool = False
    refuse_item: int | None = None
    refuse_text: str = ""
    hush_at_item: int | None = None  # stops answering, but its heart beats on
    hushes: int = 10**6  # how often
    alter_item: int | None = None
    refuse_arming: str = ""
    arming_refusals: int = 10**6  # how often it refuses before it gives in
    leave_auto_after: int | None = None
    stick_after: int | None = None
    die_after: int | None = None
    lose_reached: bool = False
    clearing: int | None = 0  # MAV_MISSION_RESULT of a MISSION_CLEAR_ALL; None: not answered
    sign_key: bytes | None = None  # signs with it, and hears nothing that is not signed with it


@dataclass
class FakeVehicle:
    """Runs in a thread of its own; `heard` keeps everything that clients sent."""

    behaviour: Behaviour
    port: int = 0
    heard: list[tuple[int, int, Any]] = field(default_factory=list)
    mission: list[Any] = field(default_factory=list)
    fence: list[Any] = field(default_factory=list)
    rally: list[Any] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._stop = threading.Event()
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port = self._server.getsockname()[1]
        self._server.settimeout(0.1)
        self._parser = dialect.MAVLink(None)
        self._parser.robust_parsing = True
        self._parser.signing.secret_key = self.behaviour.sign_key
        self._mode, self._armed, self._current, self._state = HOLD, False, 0, 2
        self._lat, self._lon = (float(value) for value in self.behaviour.at_e7)
        self._pending: dict[int, list[Any]] = {}
        self._counts: dict[int, int] = {}
        self._dead = False
        self._client = (0, 0)
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop the thread and close the sockets."""
        self._stop.set()
        self._thread.join(MOMENT_S)
        self._server.close()

    def _serve(self) -> None:
        while not self._stop.is_set():
            try:
                client, _ = self._server.accept()
            except TimeoutError:
                continue
            with client, contextlib.suppress(OSError):
                self._talk(client)
            if self._dead:
                return

    def _talk(self, client: socket.socket) -> None:
        mav = dialect.MAVLink(_Writer(client), 1, 1)
        mav.signing.secret_key = self.behaviour.sign_key
        mav.signing.sign_outgoing = self.behaviour.sign_key is not None
        mav.signing.timestamp = int((time.time() - SIGNING_EPOCH_S) * 1e5)
        client.settimeout(TICK_S / 4)
        next_beat_s = next_tick_s = time.monotonic()
        while not self._stop.is_set() and not self._dead:
            now_s = time.monotonic()
            if now_s >= next_beat_s and not self.behaviour.silent:
                next_beat_s = now_s + 0.25
                self._beat(mav)
            if now_s >= next_tick_s and not self.behaviour.silent:
                next_tick_s = now_s + TICK_S
                self._sail(mav)
            try:
                data = client.recv(65536)
            except TimeoutError:
                continue
            if not data:
                return
            for message in self._parser.parse_buffer(data) or []:
                if self.behaviour.sign_key is not None and message.get_type() == "BAD_DATA":
                    continue  # what pymavlink makes of a frame whose signature does not hold
                self._client = (message.get_srcSystem(), message.get_srcComponent())
                self.heard.append((*self._client, message))
                if not self.behaviour.silent:
                    self._handle(mav, message)

    def _beat(self, mav: Any) -> None:
        mav.heartbeat_send(
            dialect.MAV_TYPE_SURFACE_BOAT,
            self.behaviour.autopilot,
            1 | (128 if self._armed else 0),
            self._mode,
            dialect.MAV_STATE_ACTIVE if self._armed else dialect.MAV_STATE_STANDBY,
        )
        mav.mission_current_send(self._current, max(len(self.mission) - 1, 0), self._state)

    def _sail(self, mav: Any) -> None:
        speed_m_s, has_arrived = 0.0, False
        if self._armed and self._mode == AUTO and self._current < len(self.mission):
            item = self.mission[self._current]
            north, east = item.x - self._lat, (item.y - self._lon) * math.cos(math.radians(self._lat / 1e7))
            left_m = math.hypot(north, east) * METRES_PER_E7
            share = min(1.0, self.behaviour.speed_m_s * TICK_S / left_m) if left_m > 0.0 else 1.0
            if item.command != dialect.MAV_CMD_NAV_WAYPOINT:
                self._current += 1
            elif self._current - 1 != self.behaviour.stick_after:
                speed_m_s = self.behaviour.speed_m_s
                self._lat += (item.x - self._lat) * share
                self._lon += (item.y - self._lon) * share
                has_arrived = share == 1.0
        speed_cm_s = round(speed_m_s * 100.0)
        mav.global_position_int_send(0, round(self._lat), round(self._lon), 0, 0, speed_cm_s, 0, 0, 0)
        if has_arrived:
            self._reach(mav)

    def _reach(self, mav: Any) -> None:
        reached = self._current
        if not self.behaviour.lose_reached:
            mav.mission_item_reached_send(reached)
        self._dead = reached == self.behaviour.die_after
        if reached == self.behaviour.leave_auto_after:
            self._mode = HOLD
            mav.statustext_send(dialect.MAV_SEVERITY_WARNING, b"GCS lost: HOLD")
        if reached == len(self.mission) - 1:
            self._state = dialect.MISSION_STATE_COMPLETE
        self._current += 1

    def _handle(self, mav: Any, message: Any) -> None:
        kind = message.get_type()
        if kind == "COMMAND_LONG":
            mav.command_ack_send(message.command, self._obey(mav, message))
        elif kind == "MISSION_COUNT":
            self._pending[message.mission_type], self._counts[message.mission_type] = [], message.count
            self._next(mav, message.mission_type)
        elif kind == "MISSION_ITEM_INT":
            self._take_item(mav, message)
        elif kind == "MISSION_REQUEST_LIST":
            mav.mission_count_send(*self._client, len(self._list(message.mission_type)), message.mission_type)
        elif kind in {"MISSION_REQUEST_INT", "MISSION_REQUEST"}:
            self._give_item(mav, message)
        elif kind == "MISSION_CLEAR_ALL" and self.behaviour.clearing is not None:
            if self.behaviour.clearing == dialect.MAV_MISSION_ACCEPTED:
                self._list(message.mission_type).clear()
            mav.mission_ack_send(*self._client, self.behaviour.clearing, message.mission_type)
        elif kind == "MISSION_SET_CURRENT":
            self._current = message.seq
            mav.mission_current_send(self._current, max(len(self.mission) - 1, 0), self._state)

    def _list(self, mission_type: int) -> list[Any]:
        return (self.mission, self.fence, self.rally)[mission_type]

    def _obey(self, mav: Any, message: Any) -> int:
        if message.command == dialect.MAV_CMD_COMPONENT_ARM_DISARM:
            if self.behaviour.refuse_arming and self.behaviour.arming_refusals > 0:
                self.behaviour.arming_refusals -= 1
                mav.statustext_send(dialect.MAV_SEVERITY_CRITICAL, self.behaviour.refuse_arming.encode())
                return int(dialect.MAV_RESULT_FAILED)
            self._armed = True
        elif message.command == dialect.MAV_CMD_MISSION_START:
            self._mode, self._state = AUTO, dialect.MISSION_STATE_ACTIVE
            self._current = max(self._current, 1)
        elif message.command == dialect.MAV_CMD_DO_SET_MISSION_CURRENT:
            self._current = int(message.param1)
        else:
            return int(dialect.MAV_RESULT_UNSUPPORTED)
        self._beat(mav)
        return int(dialect.MAV_RESULT_ACCEPTED)

    def _next(self, mav: Any, mission_type: int) -> None:
        taken = len(self._pending[mission_type])
        if mission_type == 0 and taken == self.behaviour.hush_at_item and self.behaviour.hushes:
            self.behaviour.hushes -= 1
        elif taken < self._counts[mission_type]:
            mav.mission_request_int_send(*self._client, taken, mission_type)
        else:
            self._list(mission_type)[:] = self._pending[mission_type]
            mav.mission_ack_send(*self._client, dialect.MAV_MISSION_ACCEPTED, mission_type)

    def _take_item(self, mav: Any, message: Any) -> None:
        items = self._pending[message.mission_type]
        if message.seq == self.behaviour.refuse_item:
            if self.behaviour.refuse_text:
                mav.statustext_send(dialect.MAV_SEVERITY_WARNING, self.behaviour.refuse_text.encode())
            mav.mission_ack_send(*self._client, dialect.MAV_MISSION_INVALID_PARAM5_X, message.mission_type)
        elif message.seq == len(items):
            items.append(message)
            self._next(mav, message.mission_type)

    def _give_item(self, mav: Any, message: Any) -> None:
        item = self._list(message.mission_type)[message.seq]
        shift = 7 if message.seq == self.behaviour.alter_item else 0
        mav.mission_item_int_send(
            *self._client, item.seq, item.frame, item.command, item.current, item.autocontinue,
            item.param1, item.param2, item.param3, item.param4, item.x + shift, item.y, item.z,
            item.mission_type,
        )  # fmt: skip


@dataclass
class _Writer:
    client: socket.socket

    def write(self, data: bytes) -> None:
        self.client.sendall(data)


@contextmanager
def fake_vehicle(behaviour: Behaviour | None = None) -> Iterator[FakeVehicle]:
    """A running vehicle that is stopped afterwards."""
    vehicle = FakeVehicle(behaviour or Behaviour())
    try:
        yield vehicle
    finally:
        vehicle.close()


def link(vehicle: FakeVehicle, patience_s: int = 20) -> list[str]:
    """How the planner's programs are told to find it."""
    return ["--connect", f"tcp:127.0.0.1:{vehicle.port}", "--patience", str(patience_s)]


def zigzag_plan(folder: Path) -> str:
    """A mission file of six waypoints, 30 m apart."""
    points = [Point(30.0 * number, 10.0 * (number % 2)) for number in range(7)]
    home, *items = (MissionItem.at(FRAME.to_global(point)) for point in points)
    save_mission(Mission(tuple(items), home.place), folder / "zigzag.plan")
    return str(folder / "zigzag.plan")
