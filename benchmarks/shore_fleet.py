"""Boats that send what real ones send, as frames on memory links, for hours of handed-in time.

They answer commands, downloads of their lists, and requests for their modes, and nothing else.
"""

import math
import random
from collections.abc import Iterator

from companion.links.memory import MemoryLink, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.layout import LAYOUTS

_STATION = (250, 190)
_MODES = ("MANUAL", "HOLD", "LOITER", "AUTO", "RTL", "GUIDED")
_TEXTS = (
    "PreArm: no fix",
    "Failsafe: battery low",
    "Mission: 3 of 12",
    "Mode HOLD",
    "<script>alert(1)</script>",
)
_NEW_LIST_S, _TEXT_S, _BROKEN_TEXT_S, _LINK_S, _GARBAGE_S = 120.0, 7.0, 61.0, 600.0, 13.0
_CORNERS = (4, 40)


class FleetPort:
    """The station's port."""

    def __init__(self) -> None:
        self._fresh: list[MemoryLink] = []

    def offer(self, link: MemoryLink) -> None:
        """A new link."""
        self._fresh.append(link)

    def accept(self) -> list[MemoryLink]:
        """Links since the last call."""
        fresh, self._fresh = self._fresh, []
        return fresh

    def close(self) -> None:
        """Nothing to close."""


class FakeBoat:
    """A boat on a circle. Now and then it has a new mission, a text, another link."""

    def __init__(self, system: int, port: FleetPort) -> None:
        self._random = random.Random(system)
        self._own = Address(system, 1)
        self._port = port
        self._encoder = Encoder(self._own)
        self._decoder = Decoder(datagram=True)
        self._link: MemoryLink | None = None
        self._count = 5
        self._x = 0
        self._due: dict[str, float] = {}

    def poll(self, now_s: float) -> None:
        """Send what is due since the last call, and answer."""
        if self._link is None or self._is_due("link", now_s, _LINK_S):
            self.close()
            far, near = memory_pair(f"boat {self._own.system} at {now_s:.0f} s")
            self._link = far
            self._port.offer(near)
        for chunk in self._link.receive():
            for one in self._decoder.feed(chunk):
                self._answer(one.message)
        for message in self._telemetry(now_s):
            self._send(message)
        if self._is_due("list", now_s, _NEW_LIST_S):
            self._count, self._x = self._random.randint(*_CORNERS), self._x + 1
        if self._is_due("garbage", now_s, _GARBAGE_S):
            self._link.send(self._random.randbytes(200))

    def close(self) -> None:
        """It goes out of range."""
        if self._link is not None:
            self._link.close()

    def _is_due(self, what: str, now_s: float, every_s: float) -> bool:
        due_s = self._due.setdefault(what, now_s + self._random.uniform(0.0, every_s))
        if now_s < due_s:
            return False
        self._due[what] = max(due_s + every_s, now_s)
        return True

    def _send(self, message: Message) -> None:
        assert self._link is not None
        self._link.send(self._encoder.encode(message))

    def _telemetry(self, now_s: float) -> Iterator[Message]:
        """The mix of `station/streams.py`, and texts."""
        ms, angle = round(1e3 * now_s) & 0xFFFFFFFF, now_s / 60.0
        lat, lon = (
            round(1e7 * (48.0 + 0.001 * math.cos(angle))),
            round(1e7 * (12.0 + 0.001 * math.sin(angle))),
        )
        cm_s, heading = self._random.randint(0, 200), round(math.degrees(angle)) % 360
        d = dialect
        if self._is_due("fast", now_s, 0.2):
            yield d.MAVLink_global_position_int_message(ms, lat, lon, 0, 0, cm_s, 0, 0, heading * 100)
            yield d.MAVLink_distance_sensor_message(ms, 20, 2000, cm_s + 100, 0, 1, 0, 0)
        if self._is_due("half", now_s, 0.5):
            yield d.MAVLink_vfr_hud_message(0.0, cm_s / 100.0, heading, 30, 0.0, 0.0)
            ranges = [self._random.choice((300, 65535)) for _ in range(72)]
            yield d.MAVLink_obstacle_distance_message(ms * 1000, 0, ranges, 5, 20, 2000)
        if self._is_due("second", now_s, 1.0):
            yield d.MAVLink_heartbeat_message(11, 3, 1 | (128 if int(now_s) % 7200 > 3600 else 0), 5, 4, 3)
            yield d.MAVLink_sys_status_message(0, 0, 0, 90 + cm_s, 12_000 - cm_s, 300, 80, 0, 0, 0, 0, 0, 0)
            yield d.MAVLink_gps_raw_int_message(ms * 1000, 3, lat, lon, 0, 90, 100, cm_s, 0, 12)
            yield d.MAVLink_mission_current_message(1, self._count, 3, 1)
        if self._is_due("slow", now_s, 2.0):
            yield d.MAVLink_home_position_message(
                lat, lon, 0, 0.0, 0.0, 0.0, [1.0, 0.0, 0.0, 0.0], 0.0, 0.0, 0.0
            )
            yield d.MAVLink_debug_vect_message(b"current", ms * 1000, cm_s / 1e3, 0.1, 0.0)
        if self._is_due("text", now_s, _TEXT_S):
            text = f"{self._random.choice(_TEXTS)} {int(now_s)}".encode()
            yield d.MAVLink_statustext_message(self._random.randint(0, 7), text[:50])
        if self._is_due("broken text", now_s, _BROKEN_TEXT_S):  # its rest never comes
            yield d.MAVLink_statustext_message(4, b"x" * 50, self._random.randint(1, 65535), 0)

    def _answer(self, message: Message) -> None:
        kind, d = message.get_type(), dialect
        if kind == "COMMAND_LONG" and message.param1 == d.MAVLINK_MSG_ID_AVAILABLE_MODES:
            for number, name in enumerate(_MODES, 1):
                if d.MAVLINK_MSG_ID_AVAILABLE_MODES in LAYOUTS:
                    self._send(
                        d.MAVLink_available_modes_message(len(_MODES), number, 0, number, 0, name.encode())
                    )
        if kind in ("COMMAND_LONG", "COMMAND_INT"):
            self._send(d.MAVLink_command_ack_message(message.command, 0, 0, 0, *_STATION))
        elif kind == "MISSION_REQUEST_LIST":
            count = self._count if message.mission_type != 2 else 1
            self._send(d.MAVLink_mission_count_message(*_STATION, count, message.mission_type))
        elif kind in ("MISSION_REQUEST_INT", "MISSION_REQUEST"):
            command = (16, 5001, 5100)[message.mission_type]
            at = 480_000_000 + self._x, 120_000_000 + message.seq * 1000
            values = (0, 1, float(self._count), 0.0, 0.0, 0.0, *at, 0.0, message.mission_type)
            self._send(d.MAVLink_mission_item_int_message(*_STATION, message.seq, 0, command, *values))
