"""Schedule of telemetry messages per channel."""

import math

from companion.mavlink.dialect import dialect

# REQUEST_DATA_STREAM's groups, as in ArduPilot Rover; HOME_POSITION is in none
_ID = dialect
GROUPS: dict[int, tuple[int, ...]] = {
    _ID.MAV_DATA_STREAM_RAW_SENSORS: (_ID.MAVLINK_MSG_ID_RAW_IMU, _ID.MAVLINK_MSG_ID_SCALED_IMU),
    _ID.MAV_DATA_STREAM_EXTENDED_STATUS: (
        _ID.MAVLINK_MSG_ID_SYS_STATUS,
        _ID.MAVLINK_MSG_ID_POWER_STATUS,
        _ID.MAVLINK_MSG_ID_MEMINFO,
        _ID.MAVLINK_MSG_ID_MISSION_CURRENT,
        _ID.MAVLINK_MSG_ID_GPS_RAW_INT,
        _ID.MAVLINK_MSG_ID_GPS_RTK,
        _ID.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT,
        _ID.MAVLINK_MSG_ID_FENCE_STATUS,
        _ID.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT,
    ),
    _ID.MAV_DATA_STREAM_RC_CHANNELS: (
        _ID.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW,
        _ID.MAVLINK_MSG_ID_RC_CHANNELS,
        _ID.MAVLINK_MSG_ID_RELAY_STATUS,
    ),
    _ID.MAV_DATA_STREAM_POSITION: (
        _ID.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
        _ID.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
    ),
    _ID.MAV_DATA_STREAM_EXTRA1: (_ID.MAVLINK_MSG_ID_ATTITUDE, _ID.MAVLINK_MSG_ID_PID_TUNING),
    _ID.MAV_DATA_STREAM_EXTRA2: (_ID.MAVLINK_MSG_ID_VFR_HUD,),
    _ID.MAV_DATA_STREAM_EXTRA3: (
        _ID.MAVLINK_MSG_ID_SYSTEM_TIME,
        _ID.MAVLINK_MSG_ID_BATTERY_STATUS,
        _ID.MAVLINK_MSG_ID_DISTANCE_SENSOR,
        _ID.MAVLINK_MSG_ID_WATER_DEPTH,
        _ID.MAVLINK_MSG_ID_OBSTACLE_DISTANCE,
        _ID.MAVLINK_MSG_ID_EKF_STATUS_REPORT,
    ),
}

# Default rates, as a share of the configured stream rate
_UNASKED: dict[int, float] = {
    _ID.MAVLINK_MSG_ID_ATTITUDE: 1.0,
    _ID.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 1.0,
    _ID.MAVLINK_MSG_ID_VFR_HUD: 1.0,
    _ID.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: 0.5,
    _ID.MAVLINK_MSG_ID_LOCAL_POSITION_NED: 0.25,
    _ID.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: 0.25,
    _ID.MAVLINK_MSG_ID_GPS_RAW_INT: 0.25,
    _ID.MAVLINK_MSG_ID_GPS_RTK: 0.25,
    _ID.MAVLINK_MSG_ID_SYS_STATUS: 0.25,
    _ID.MAVLINK_MSG_ID_MISSION_CURRENT: 0.25,
    _ID.MAVLINK_MSG_ID_PID_TUNING: 0.125,
    _ID.MAVLINK_MSG_ID_SYSTEM_TIME: 0.125,
    _ID.MAVLINK_MSG_ID_BATTERY_STATUS: 0.125,
    _ID.MAVLINK_MSG_ID_FENCE_STATUS: 0.125,
    _ID.MAVLINK_MSG_ID_HOME_POSITION: 0.125,
    _ID.MAVLINK_MSG_ID_DISTANCE_SENSOR: 0.5,
    _ID.MAVLINK_MSG_ID_WATER_DEPTH: 0.5,
    _ID.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: 0.25,
    _ID.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: 0.25,
    _ID.MAVLINK_MSG_ID_RC_CHANNELS: 0.125,
    _ID.MAVLINK_MSG_ID_EKF_STATUS_REPORT: 0.125,
    _ID.MAVLINK_MSG_ID_POWER_STATUS: 0.125,
    _ID.MAVLINK_MSG_ID_MEMINFO: 0.125,
    _ID.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 0.125,
    _ID.MAVLINK_MSG_ID_RELAY_STATUS: 0.125,
    _ID.MAVLINK_MSG_ID_WINCH_STATUS: 0.125,
}

MIN_INTERVAL_S = 0.02  # the tick
_SLACK_S = 1e-6  # rounding errors of the intervals
_ONCE_A_SECOND_S = 1.0


class Streams:
    """The schedule of one channel. Missed messages are not sent later."""

    def __init__(self, stream_hz: float) -> None:
        self._interval_s: dict[int, float] = {}
        self._due_s: dict[int, float] = {}
        self._next_s = math.inf
        self.stream_hz = stream_hz
        if stream_hz > 0.0:
            for message_id in _UNASKED:
                self.set_interval(message_id, self.default_s(message_id), 0.0)

    def default_s(self, message_id: int) -> float:
        """The default interval; a second for messages not sent by default."""
        rate_hz = self.stream_hz * _UNASKED.get(message_id, 0.0)
        return 1.0 / rate_hz if rate_hz > 0.0 else _ONCE_A_SECOND_S

    def set_interval(self, message_id: int, interval_s: float, now_s: float) -> None:
        """Send a message every interval_s; infinite stops it."""
        if math.isinf(interval_s):
            self._interval_s.pop(message_id, None)
            self._due_s.pop(message_id, None)
        else:
            self._interval_s[message_id] = max(interval_s, MIN_INTERVAL_S)
            self._due_s[message_id] = now_s
        self._next_s = min(self._due_s.values(), default=math.inf)

    def interval_s(self, message_id: int) -> float:
        """The interval of a message, infinite if not sent."""
        return self._interval_s.get(message_id, math.inf)

    def set_group(self, group: int, rate_hz: float, now_s: float) -> None:
        """REQUEST_DATA_STREAM: rate of a group; 0 stops it. Group 0 is all groups."""
        interval_s = 1.0 / rate_hz if rate_hz > 0.0 else math.inf
        groups = list(GROUPS) if group == dialect.MAV_DATA_STREAM_ALL else [group]
        for message_id in (number for one in groups for number in GROUPS.get(one, ())):
            self.set_interval(message_id, interval_s, now_s)

    def has_due(self, now_s: float) -> bool:
        """Whether any message is due."""
        return now_s + _SLACK_S >= self._next_s

    def due(self, now_s: float) -> list[int]:
        """The messages due now."""
        now_s += _SLACK_S
        if now_s < self._next_s:
            return []
        due = [message_id for message_id, at_s in self._due_s.items() if at_s <= now_s]
        for message_id in due:
            interval_s = self._interval_s[message_id]
            missed = math.floor((now_s - self._due_s[message_id]) / interval_s)
            self._due_s[message_id] += (missed + 1) * interval_s
        self._next_s = min(self._due_s.values())
        return due
