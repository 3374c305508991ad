"""What is so of each part of a boat: a state and values by name, one small function a part.

A state comes from what the boat says (the bits of SYS_STATUS, EKF_STATUS_REPORT) and from the values' age.
"""

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple

from companion.mavlink.dialect import Message, dialect
from mission_tools.station.messages import Reason
from mission_tools.station.setup.latest_messages import RANGER, SOUNDER, LatestMessages
from mission_tools.station.view import View, bearing_deg, range_m

_STALE_S: Final = 3.0  # a receiver with one fix a second that misses two
_DOUBTED: Final = 0.5  # EKF_STATUS_REPORT: half the way to the limit at which the boat rejects a sensor
_REPLACED: Final = 0.8  # … another source replaces it
_INACCURATE_HDOP: Final = 2.5  # as arming.max_hdop by default
_BUSY: Final = 0.95
_HOT_C: Final = 80.0  # where a Raspberry Pi slows down
_UNKNOWN_16: Final = 0xFFFF
_REST_US: Final = 1500

Values = dict[str, Any]
Found = tuple[str, Values]
Board = dict[str, Any]


class SensorSnapshot(NamedTuple):
    """All that a verdict may use. board: of the server's own computer, if the boat runs there."""

    messages: LatestMessages
    view: View
    reasons: Sequence[Reason]
    now_s: float
    is_heard: bool
    board: Board

    def bit(self, sensor: int) -> bool | None:
        """SYS_STATUS: whether a part works; None where it is not fitted, or nothing was heard yet."""
        status = self.messages.latest(dialect.MAVLINK_MSG_ID_SYS_STATUS)
        if status is None or not status.onboard_control_sensors_present & sensor:
            return None
        return bool(status.onboard_control_sensors_health & sensor)

    @property
    def is_told(self) -> bool:
        """Whether SYS_STATUS was heard."""
        return self.messages.latest(dialect.MAVLINK_MSG_ID_SYS_STATUS) is not None

    @property
    def estimate(self) -> Message | None:
        """How far the boat's filter trusts each sensor."""
        return self.messages.latest(dialect.MAVLINK_MSG_ID_EKF_STATUS_REPORT)

    def is_older(self, key: int | str, limit_s: float) -> bool:
        """Whether a part has measured nothing new for so long."""
        age_s = self.messages.age_s(key, self.now_s)
        return age_s is None or age_s > limit_s


def _share(value: float) -> float:
    return value if math.isfinite(value) else 1.0


def examine_gnss(seen: SensorSnapshot) -> Found:
    """Fix, satellites and accuracy, with a verdict."""
    fix, estimate = seen.messages.latest(dialect.MAVLINK_MSG_ID_GPS_RAW_INT), seen.estimate
    if fix is None:
        return "unheard", {}
    values: Values = {"fix": fix.fix_type}
    if fix.satellites_visible != 0xFF:
        values["satellites"] = fix.satellites_visible
    if fix.fix_type >= dialect.GPS_FIX_TYPE_2D_FIX:
        if fix.eph != _UNKNOWN_16:
            values["hdop"] = fix.eph / 100.0
        if fix.h_acc:
            values["error_m"] = fix.h_acc / 1e3
    if fix.fix_type == dialect.GPS_FIX_TYPE_NO_GPS:
        return "none", values
    if seen.is_older(dialect.MAVLINK_MSG_ID_GPS_RAW_INT, _STALE_S):
        return "silent", values
    if fix.fix_type < dialect.GPS_FIX_TYPE_2D_FIX:
        return "no_fix", values
    if estimate is not None and estimate.flags & dialect.EKF_GPS_GLITCHING:
        return "doubted", values
    if fix.fix_type == dialect.GPS_FIX_TYPE_2D_FIX:
        return "flat", values
    if estimate is not None and _share(estimate.pos_horiz_variance) >= _REPLACED:
        return "replaced", values
    return ("inaccurate" if values.get("hdop", 0.0) > _INACCURATE_HDOP else "good"), values


def examine_compass(seen: SensorSnapshot) -> Found:
    """Heading, field strength (mG), and how far it disagrees (0 to 1)."""
    imu, estimate = seen.messages.latest(dialect.MAVLINK_MSG_ID_SCALED_IMU), seen.estimate
    values: Values = {}
    if seen.view.heading_deg is not None:
        values["heading_deg"] = round(seen.view.heading_deg, 1)
    if imu is not None and (field := math.hypot(imu.xmag, imu.ymag, imu.zmag)):
        values["field_mg"] = round(field)
    if estimate is not None:
        values["doubt"] = round(min(_share(estimate.compass_variance), 1.0), 2)
    if not seen.is_told:
        return "unheard", values
    if seen.bit(dialect.MAV_SYS_STATUS_SENSOR_3D_MAG) is False or values.get("doubt", 0.0) >= 1.0:
        return "lost", values
    if values.get("doubt", 0.0) >= _REPLACED:
        return "replaced", values
    return ("doubted" if values.get("doubt", 0.0) >= _DOUBTED else "good"), values


def examine_gyro(seen: SensorSnapshot) -> Found:
    """Turn rate, with a verdict."""
    imu = seen.messages.latest(dialect.MAVLINK_MSG_ID_SCALED_IMU)
    if not seen.is_told:
        return "unheard", {}
    is_well = seen.bit(dialect.MAV_SYS_STATUS_SENSOR_3D_GYRO)
    if is_well is None:
        return "absent", {}
    values: Values = {} if imu is None else {"rate_deg_s": round(math.degrees(imu.zgyro / 1e3), 1)}
    return ("good" if is_well else "silent"), values


def examine_sonar(seen: SensorSnapshot) -> Found:
    """The latest ping: bearing, range, reach."""
    ping = seen.messages.latest(RANGER)
    if not seen.is_told:
        return "unheard", {}
    is_well = seen.bit(dialect.MAV_SYS_STATUS_SENSOR_PROXIMITY)
    if is_well is None and ping is None:
        return "absent", {}
    values: Values = {}
    if ping is not None:
        values = {
            "reach_m": ping.max_distance / 100.0,
            "bearing_deg": bearing_deg(ping),
            "range_m": range_m(ping),
        }
        values = {name: value for name, value in values.items() if value is not None}
    if is_well is False or seen.is_older(RANGER, _STALE_S):
        return "silent", values
    return ("good" if "range_m" in values else "no_echo"), values


def examine_depth(seen: SensorSnapshot) -> Found:
    """Depth below the transducer, temperature of the water."""
    sounding = seen.messages.latest(SOUNDER)
    depth = seen.messages.latest(dialect.MAVLINK_MSG_ID_WATER_DEPTH)
    if sounding is None:
        return "absent", {}
    values: Values = {} if (depth_m := range_m(sounding)) is None else {"depth_m": depth_m}
    if depth is not None and math.isfinite(depth.temperature) and depth.temperature:
        values["water_c"] = round(depth.temperature, 1)
    if seen.is_older(SOUNDER, _STALE_S):
        return "silent", values
    return ("good" if "depth_m" in values else "no_bottom"), values


def examine_battery(seen: SensorSnapshot) -> Found:
    """Voltage, current, charge, cells as far as told."""
    status = seen.messages.latest(dialect.MAVLINK_MSG_ID_SYS_STATUS)
    if status is None:
        return "unheard", {}
    is_well = seen.bit(dialect.MAV_SYS_STATUS_SENSOR_BATTERY)
    if is_well is None:
        return "absent", {}
    values: Values = {}
    is_measured = status.voltage_battery != _UNKNOWN_16
    if is_measured:
        values["voltage_v"] = status.voltage_battery / 1e3
    if status.current_battery >= 0:
        values["current_a"] = status.current_battery / 100.0
    if 0 <= status.battery_remaining <= 100:
        values["percent"] = status.battery_remaining
    if seen.view.battery_left_s is not None and seen.view.has_sailed:
        values["left_s"] = seen.view.battery_left_s
    pack = seen.messages.latest(dialect.MAVLINK_MSG_ID_BATTERY_STATUS)
    cells = [] if pack is None else [one / 1e3 for one in pack.voltages if 0 < one < _UNKNOWN_16 - 1]
    if len(cells) > 1:
        values["cells_v"] = cells
    if not is_measured:
        return "silent", values
    return ("low" if not is_well else "good" if "current_a" in values else "no_current"), values


def examine_rc(seen: SensorSnapshot) -> Found:
    """Channels and signal (0 to 1)."""
    channels = seen.messages.latest(dialect.MAVLINK_MSG_ID_RC_CHANNELS)
    if not seen.is_told:
        return "unheard", {}
    is_well = seen.bit(dialect.MAV_SYS_STATUS_SENSOR_RC_RECEIVER)
    if is_well is None:
        return "absent", {}
    values: Values = {}
    if channels is not None:
        count = min(channels.chancount, 18)
        each = [getattr(channels, f"chan{number}_raw") for number in range(1, count + 1)]
        if each:
            values["channels_us"] = [one for one in each if one != _UNKNOWN_16]
        if channels.rssi != 0xFF:
            values["signal"] = round(channels.rssi / 254.0, 2)
    return ("good" if is_well else "off"), values


def examine_motors(seen: SensorSnapshot) -> Found:
    """Pulse widths of the left and the right motor."""
    outputs = seen.messages.latest(dialect.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW)
    if outputs is None:
        return "unheard", {}
    left, right = outputs.servo1_raw, outputs.servo3_raw
    values: Values = {"left_us": left, "right_us": right}
    is_turning = any(one not in (0, _REST_US) for one in (left, right))
    return ("turning" if is_turning else "rest"), values


def examine_clock(seen: SensorSnapshot) -> Found:
    """How long the boat runs, and its date (seconds since 1970)."""
    time = seen.messages.latest(dialect.MAVLINK_MSG_ID_SYSTEM_TIME)
    if time is None:
        return "unheard", {}
    values: Values = {"running_s": time.time_boot_ms // 1000}
    if not time.time_unix_usec:
        return "unknown", values
    values["date_s"] = time.time_unix_usec // 1_000_000
    return "good", values


def examine_computer(seen: SensorSnapshot) -> Found:
    """Load of the tick (0 to 1), memory, temperature, disk."""
    if not seen.is_told or seen.view.load is None:
        return "unheard", {}
    values: Values = {"load": seen.view.load}
    memory = seen.messages.latest(dialect.MAVLINK_MSG_ID_MEMINFO)
    if memory is not None and (free := memory.freemem32 or memory.freemem):
        values["memory_mb"] = round(free / 1e6)
    for name, key in (("temperature_c", "temperature_c"), ("disk_mb", "disk_free_mb")):
        if seen.board.get(key) is not None:
            values[name] = seen.board[key]
    if seen.view.load >= _BUSY:
        return "busy", values
    return ("hot" if values.get("temperature_c", 0.0) >= _HOT_C else "good"), values
