"""The telemetry that the page needs, asked of one boat by SET_MESSAGE_INTERVAL.

What does not come is asked for again, ever more rarely: a boat without a ranger never sends its pings.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.shore.station.wire import command_long

INTERVALS_S: Final[dict[int, float]] = {
    dialect.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 0.2,
    dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR: 0.2,
    dialect.MAVLINK_MSG_ID_VFR_HUD: 0.5,
    dialect.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: 0.5,
    dialect.MAVLINK_MSG_ID_SYS_STATUS: 1.0,
    dialect.MAVLINK_MSG_ID_GPS_RAW_INT: 1.0,
    dialect.MAVLINK_MSG_ID_MISSION_CURRENT: 1.0,
    dialect.MAVLINK_MSG_ID_EKF_STATUS_REPORT: 1.0,
    dialect.MAVLINK_MSG_ID_DEBUG_VECT: 2.0,
    dialect.MAVLINK_MSG_ID_BATTERY_STATUS: 2.0,
    dialect.MAVLINK_MSG_ID_HOME_POSITION: 2.0,
}
_FIRST_CHECK_S: Final = 5.0
_RAREST_S: Final = 80.0
_ENOUGH: Final = 0.4  # of the messages expected: radios lose some


@dataclass(slots=True)
class _Stream:
    check_s: float
    wait_s: float = _FIRST_CHECK_S
    heard: int = 0


class Streams:
    """The streams of one boat over one link."""

    def __init__(self, boat: Address, send: Callable[[Message], None]) -> None:
        self._boat = boat
        self._send = send
        self._streams: dict[int, _Stream] = {}
        self._modes_s = self._cruise_s = float("-inf")

    def restart(self) -> None:
        """Another link, or another start of the boat's program: ask for everything again."""
        self._streams.clear()
        self._modes_s = self._cruise_s = float("-inf")

    def on_message(self, message_id: int) -> None:
        """A message has come."""
        if (stream := self._streams.get(message_id)) is not None:
            stream.heard += 1

    def poll(self, now_s: float, *, has_modes: bool, has_cruise: bool) -> None:
        """Ask for what is missing."""
        for message_id, interval_s in INTERVALS_S.items():
            stream = self._streams.get(message_id)
            if stream is None:
                self._streams[message_id] = _Stream(now_s + _FIRST_CHECK_S)
                self._ask(message_id, interval_s)
            elif now_s >= stream.check_s:
                if stream.heard < _ENOUGH * stream.wait_s / interval_s:
                    stream.wait_s = min(2.0 * stream.wait_s, _RAREST_S)
                    self._ask(message_id, interval_s)
                stream.heard, stream.check_s = 0, now_s + stream.wait_s
        if not has_modes and now_s - self._modes_s >= _FIRST_CHECK_S:
            self._modes_s = now_s
            number = dialect.MAVLINK_MSG_ID_AVAILABLE_MODES
            self._send(command_long(self._boat, dialect.MAV_CMD_REQUEST_MESSAGE, number))
        if not has_cruise and now_s - self._cruise_s >= _RAREST_S:
            self._cruise_s = now_s
            self._send(dialect.MAVLink_param_request_read_message(*self._boat, b"CRUISE_SPEED", -1))

    def _ask(self, message_id: int, interval_s: float) -> None:
        number = dialect.MAV_CMD_SET_MESSAGE_INTERVAL
        self._send(command_long(self._boat, number, message_id, round(interval_s * 1e6)))
