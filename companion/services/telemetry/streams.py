"""Schedule of telemetry messages per channel."""

import math

from companion.mavlink.dialect import dialect, message_ids

# REQUEST_DATA_STREAM's groups, as in ArduPilot Rover; HOME_POSITION is in none
GROUPS: dict[int, tuple[int, ...]] = {
    dialect.MAV_DATA_STREAM_RAW_SENSORS: message_ids("RAW_IMU", "SCALED_IMU"),
    dialect.MAV_DATA_STREAM_EXTENDED_STATUS: message_ids(
        *("SYS_STATUS", "POWER_STATUS", "MEMINFO", "MISSION_CURRENT", "GPS_RAW_INT", "GPS_RTK"),
        *("NAV_CONTROLLER_OUTPUT", "FENCE_STATUS", "POSITION_TARGET_GLOBAL_INT"),
    ),
    dialect.MAV_DATA_STREAM_RC_CHANNELS: message_ids("SERVO_OUTPUT_RAW", "RC_CHANNELS", "RELAY_STATUS"),
    dialect.MAV_DATA_STREAM_POSITION: message_ids("GLOBAL_POSITION_INT", "LOCAL_POSITION_NED"),
    dialect.MAV_DATA_STREAM_EXTRA1: message_ids("ATTITUDE", "PID_TUNING"),
    dialect.MAV_DATA_STREAM_EXTRA2: message_ids("VFR_HUD"),
    dialect.MAV_DATA_STREAM_EXTRA3: message_ids(
        *("SYSTEM_TIME", "BATTERY_STATUS", "DISTANCE_SENSOR", "WATER_DEPTH", "OBSTACLE_DISTANCE"),
        *("EKF_STATUS_REPORT", "ESC_TELEMETRY_1_TO_4"),
    ),
}

# Default rates, as a share of the configured stream rate
_UNASKED: dict[int, float] = {
    **dict.fromkeys(message_ids("ATTITUDE", "GLOBAL_POSITION_INT", "VFR_HUD"), 1.0),
    **dict.fromkeys(message_ids("NAV_CONTROLLER_OUTPUT", "DISTANCE_SENSOR", "WATER_DEPTH"), 0.5),
    **dict.fromkeys(
        message_ids(
            *("LOCAL_POSITION_NED", "SERVO_OUTPUT_RAW", "GPS_RAW_INT", "GPS_RTK", "SYS_STATUS"),
            *("MISSION_CURRENT", "OBSTACLE_DISTANCE", "POSITION_TARGET_GLOBAL_INT"),
        ),
        0.25,
    ),
    **dict.fromkeys(
        message_ids(
            *("PID_TUNING", "SYSTEM_TIME", "BATTERY_STATUS", "FENCE_STATUS", "HOME_POSITION", "RC_CHANNELS"),
            *("EKF_STATUS_REPORT", "POWER_STATUS", "MEMINFO", "EXTENDED_SYS_STATE", "RELAY_STATUS"),
            *("WINCH_STATUS", "ESC_TELEMETRY_1_TO_4"),
        ),
        0.125,
    ),
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
        return now_s + _SLACK_S >= self._next_s

    def due(self, now_s: float) -> list[int]:
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
