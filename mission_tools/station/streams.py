"""The telemetry that the page needs, asked of one boat by SET_MESSAGE_INTERVAL.

What does not come is asked for again, ever more rarely: a boat without a ranger never sends its pings.
What only the list of sensors needs is asked for while that is open, and given back to the boat's own rate
afterwards.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.wire import command_long

INTERVALS_S: Final[dict[int, float]] = {
    dialect.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 0.2,
    dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR: 0.2,
    dialect.MAVLINK_MSG_ID_VFR_HUD: 0.5,
    dialect.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: 0.5,
    dialect.MAVLINK_MSG_ID_SYS_STATUS: 1.0,
    dialect.MAVLINK_MSG_ID_GPS_RAW_INT: 1.0,
    dialect.MAVLINK_MSG_ID_MISSION_CURRENT: 1.0,
    dialect.MAVLINK_MSG_ID_EKF_STATUS_REPORT: 1.0,
    dialect.MAVLINK_MSG_ID_SYSTEM_TIME: 1.0,
    dialect.MAVLINK_MSG_ID_DEBUG_VECT: 2.0,
    dialect.MAVLINK_MSG_ID_BATTERY_STATUS: 2.0,
    dialect.MAVLINK_MSG_ID_HOME_POSITION: 2.0,
}
SENSORS_S: Final[dict[int, float]] = {
    dialect.MAVLINK_MSG_ID_SCALED_IMU: 0.25,
    dialect.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: 0.25,
    dialect.MAVLINK_MSG_ID_RC_CHANNELS: 0.5,
    dialect.MAVLINK_MSG_ID_SYS_STATUS: 0.25,
    dialect.MAVLINK_MSG_ID_GPS_RAW_INT: 0.5,
    dialect.MAVLINK_MSG_ID_EKF_STATUS_REPORT: 0.5,
    dialect.MAVLINK_MSG_ID_BATTERY_STATUS: 0.5,
    dialect.MAVLINK_MSG_ID_WATER_DEPTH: 0.5,
    dialect.MAVLINK_MSG_ID_SYSTEM_TIME: 1.0,
    dialect.MAVLINK_MSG_ID_MEMINFO: 1.0,
}
_ON_REQUEST: Final = frozenset({dialect.MAVLINK_MSG_ID_SCALED_IMU})  # the boat sends none by itself
WANTED_S: Final = 3.0  # after each look at the sensors
_FIRST_CHECK_S: Final = 5.0
_RAREST_S: Final = 80.0
_ENOUGH: Final = 0.4  # of the messages expected: radios lose some
_TOO_MANY: Final = 1.3  # a give-back was lost; a boat whose messages come faster is asked ever more rarely
_RETURNS: Final = 3  # a give-back may be lost
_RETURN_S: Final = 1.0


@dataclass(slots=True)
class _Stream:
    interval_s: float
    check_s: float
    wait_s: float = _FIRST_CHECK_S
    heard: int = 0


@dataclass(slots=True)
class _Return:
    due_s: float
    left: int = _RETURNS


class Streams:
    """The streams of one boat over one link."""

    def __init__(self, boat: Address, send: Callable[[Message], None]) -> None:
        self._boat = boat
        self._send = send
        self._streams: dict[int, _Stream] = {}
        self._returns: dict[int, _Return] = {}
        self._sensors_until_s = float("-inf")
        self._modes_s = self._cruise_s = float("-inf")

    def restart(self) -> None:
        """Another link, or another start of the boat's program: ask for everything again."""
        self._streams.clear()
        self._returns.clear()
        self._modes_s = self._cruise_s = float("-inf")

    def on_message(self, message_id: int) -> None:
        """A message has come."""
        if (stream := self._streams.get(message_id)) is not None:
            stream.heard += 1

    def want_sensors(self, now_s: float) -> None:
        """Somebody looks at the sensors."""
        self._sensors_until_s = now_s + WANTED_S

    def poll(self, now_s: float, *, has_modes: bool, has_cruise: bool) -> None:
        """Ask for what is missing."""
        wanted = INTERVALS_S | SENSORS_S if now_s < self._sensors_until_s else INTERVALS_S
        for message_id, interval_s in wanted.items():
            self._keep(message_id, interval_s, now_s)
        for message_id in self._streams.keys() - wanted.keys():
            del self._streams[message_id]
            self._returns[message_id] = _Return(now_s)
        for message_id, one in list(self._returns.items()):
            if now_s >= one.due_s:
                self._ask(message_id, -1e-6 if message_id in _ON_REQUEST else 0.0)
                one.left, one.due_s = one.left - 1, now_s + _RETURN_S
                if not one.left:
                    del self._returns[message_id]
        if not has_modes and now_s - self._modes_s >= _FIRST_CHECK_S:
            self._modes_s = now_s
            number = dialect.MAVLINK_MSG_ID_AVAILABLE_MODES
            self._send(command_long(self._boat, dialect.MAV_CMD_REQUEST_MESSAGE, number))
        if not has_cruise and now_s - self._cruise_s >= _RAREST_S:
            self._cruise_s = now_s
            self._send(dialect.MAVLink_param_request_read_message(*self._boat, b"CRUISE_SPEED", -1))

    def _keep(self, message_id: int, interval_s: float, now_s: float) -> None:
        stream = self._streams.get(message_id)
        if stream is None or stream.interval_s != interval_s:
            self._returns.pop(message_id, None)
            self._streams[message_id] = _Stream(interval_s, now_s + _FIRST_CHECK_S)
            self._ask(message_id, interval_s)
        elif now_s >= stream.check_s:
            share = stream.heard * interval_s / stream.wait_s
            if not _ENOUGH <= share <= _TOO_MANY:
                stream.wait_s = min(2.0 * stream.wait_s, _RAREST_S)
                self._ask(message_id, interval_s)
            stream.heard, stream.check_s = 0, now_s + stream.wait_s

    def _ask(self, message_id: int, interval_s: float) -> None:
        number = dialect.MAV_CMD_SET_MESSAGE_INTERVAL
        self._send(command_long(self._boat, number, message_id, round(interval_s * 1e6)))
