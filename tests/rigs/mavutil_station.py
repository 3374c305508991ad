"""A ground station in a few lines of pymavlink's own connection, which none of our code wrote."""

import itertools
import math
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

from patience import MOMENT_S
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as dialect

BOAT = (1, 1)

Message = Any


class Place(NamedTuple):
    """A waypoint as it goes over the wire: command, frame, 1e7 degrees."""

    command: int
    frame: int
    lat_e7: int
    lon_e7: int


HOME = Place(dialect.MAV_CMD_NAV_WAYPOINT, dialect.MAV_FRAME_GLOBAL, 500000000, -12000000)


def zigzag(waypoints: int, north_e7: int = 1000) -> list[Place]:
    """Home, then waypoints to the north of it, left and right in turn."""
    command, frame = dialect.MAV_CMD_NAV_WAYPOINT, dialect.MAV_FRAME_GLOBAL_RELATIVE_ALT
    return [HOME] + [
        Place(command, frame, HOME.lat_e7 + number * north_e7, HOME.lon_e7 + number % 2 * 1000)
        for number in range(1, waypoints + 1)
    ]


class MavutilStation:
    """Connects by TCP, and hears a heartbeat before anything else."""

    def __init__(
        self,
        port: int,
        system_id: int = 255,
        component_id: int = dialect.MAV_COMP_ID_MISSIONPLANNER,
    ) -> None:
        self.link = mavutil.mavlink_connection(
            f"tcp:127.0.0.1:{port}", source_system=system_id, source_component=component_id, retries=1
        )
        self.mav = self.link.mav
        self.wait_for("HEARTBEAT", lambda heartbeat: heartbeat.get_srcComponent() == 1)

    def close(self) -> None:
        """Hang up."""
        self.link.close()

    def wait_for(
        self,
        kinds: str | Sequence[str],
        condition: Callable[[Message], object] = bool,
        timeout_s: float = MOMENT_S,
    ) -> Message:
        """The next message of a kind that meets a condition."""
        give_up_s = time.monotonic() + timeout_s
        while (left_s := give_up_s - time.monotonic()) > 0.0:
            message = self.link.recv_match(type=kinds, blocking=True, timeout=left_s)
            if message is not None and condition(message):
                return message
        raise AssertionError(f"no such {kinds} within {timeout_s} s")

    def mode(self) -> int:
        """The mode in the boat's next heartbeat: it passes on those of other programs, which have none."""
        return int(self.wait_for("HEARTBEAT", lambda beat: beat.get_srcSystem() == BOAT[0]).custom_mode)

    def listen(self, boat_s: float) -> list[Message]:
        """Everything that is heard from now on, until the boat's own clock has advanced by a time.

        A busy machine stretches the boat's time, so a wait by the wall clock may see none of it pass.
        """
        self.drain()
        heard = [self.wait_for("SYSTEM_TIME")]
        end_ms = heard[0].time_boot_ms + 1000.0 * boat_s
        while getattr(heard[-1], "time_boot_ms", 0.0) < end_ms:
            message = self.link.recv_match(blocking=True, timeout=MOMENT_S)
            assert message is not None, f"nothing was heard for {MOMENT_S} s"
            heard.append(message)
        return heard

    def drain(self) -> None:
        """Forget what has come already."""
        while self.link.recv_match(blocking=False) is not None:
            pass

    def command(self, number: int, *params: float) -> int:
        """Send a command; returns the MAV_RESULT of its answer."""
        self.mav.command_long_send(*BOAT, number, 0, *params, *[0.0] * (7 - len(params)))
        return int(self.wait_for("COMMAND_ACK", lambda ack: ack.command == number).result)

    def arm(self) -> int:
        """Ask to arm."""
        return self.command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0)

    def enter(self, mode: int) -> int:
        """Ask for one of Rover's modes."""
        flag = float(dialect.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED)
        return self.command(dialect.MAV_CMD_DO_SET_MODE, flag, float(mode))

    def heartbeat(self, kind: int = dialect.MAV_TYPE_GCS) -> None:
        """Say that we are here."""
        self.mav.heartbeat_send(kind, dialect.MAV_AUTOPILOT_INVALID, 0, 0, 0)

    def parameters(self) -> dict[str, float]:
        """The boat's parameters, asked for as a list and complete."""
        self.mav.param_request_list_send(*BOAT)
        values: dict[str, float] = {}
        for _ in itertools.count():
            value = self.wait_for("PARAM_VALUE")
            values[value.param_id] = value.param_value
            if len(values) == value.param_count:
                break
        return values

    def offer(self, count: int) -> None:
        """Begin an upload."""
        self.mav.mission_count_send(*BOAT, count, dialect.MAV_MISSION_TYPE_MISSION)

    def give(self, places: Sequence[Place], before: Iterable[int]) -> None:
        """Answer the boat's requests for these items, in whatever order and however often they come."""
        wanted = set(before)
        while wanted:
            seq = self.wait_for(["MISSION_REQUEST_INT", "MISSION_REQUEST"]).seq
            self.give_one(places, seq)
            wanted.discard(seq)

    def give_one(self, places: Sequence[Place], seq: int) -> None:
        """Send one item."""
        place = places[seq]
        params = (0.0, 0.0, 0.0, math.nan)
        self.mav.mission_item_int_send(
            *BOAT, seq, place.frame, place.command, 0, 1, *params, place.lat_e7, place.lon_e7, 0.0, 0
        )

    def upload(self, places: Sequence[Place]) -> int:
        """Replace the mission; returns the MAV_MISSION_RESULT."""
        self.offer(len(places))
        self.give(places, range(len(places)))
        return int(self.wait_for("MISSION_ACK").type)

    def download(self) -> list[Place]:
        """The mission that the boat holds."""
        self.mav.mission_request_list_send(*BOAT, dialect.MAV_MISSION_TYPE_MISSION)
        places: list[Place] = []
        for seq in range(self.wait_for("MISSION_COUNT").count):
            self.mav.mission_request_int_send(*BOAT, seq, dialect.MAV_MISSION_TYPE_MISSION)
            item = self.wait_for("MISSION_ITEM_INT", lambda item: item.seq == len(places))
            places.append(Place(item.command, item.frame, item.x, item.y))
        self.mav.mission_ack_send(*BOAT, dialect.MAV_MISSION_ACCEPTED, dialect.MAV_MISSION_TYPE_MISSION)
        return places

    def metres_from(self, place: Place) -> float:
        """How far the boat now is from a place, on a plane."""
        at = self.wait_for("GLOBAL_POSITION_INT")
        north, east = at.lat - place.lat_e7, (at.lon - place.lon_e7) * math.cos(math.radians(at.lat / 1e7))
        return math.hypot(north, east) * 0.0111319


OpenStation = Callable[..., MavutilStation]  # port, then a system id other than 255
