"""Readings from an autopilot's messages, with the meaning that ArduPilot and PX4 give their fields.

GPS_RAW_INT is the receiver's own fix, so the boat's filter does not filter twice. Heading and yaw rate are of
ATTITUDE: of the autopilot's filter, from true north.
"""

import math
from collections import deque
from collections.abc import Callable
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.geo import position_from_e7
from companion.core.readings import (
    BatteryReading,
    DepthReading,
    GnssFix,
    HeadingReading,
    RcReading,
    SonarReading,
)
from companion.mavlink.dialect import Message, dialect
from companion.sensors.receiver_clock import ReceiverClock

_UNKNOWN_16: Final = 0xFFFF
_UNKNOWN_8: Final = 0xFF
_WINDOW_S: Final = 5.0  # two hundred ATTITUDE; an autopilot that is simulated may fall behind real time
_HEALTH_S: Final = 3.0  # without a report of health none is assumed: six of each
_VARIANCE: Final = 1.0  # from there on the filter rejects the compass (test ratio of its innovation)
_CUT: Final = 0.5  # units of GPS_RAW_INT that are cut off, on average
_MOST_PINGS: Final = 32
_DOWN: Final = dialect.MAV_SENSOR_ROTATION_PITCH_270
_YAW_STEPS: Final = 8  # MAV_SENSOR_ROTATION_NONE, _YAW_45 … _YAW_315 are 0 to 7
_COMPASS_BITS: Final = dialect.MAV_SYS_STATUS_AHRS | dialect.MAV_SYS_STATUS_SENSOR_3D_MAG
_REBOOT_S: Final = 1.0  # by which the autopilot's clock falls at least


class AutopilotReadings:
    """The latest readings, each None before its first. reboots: how often its clock began anew."""

    def __init__(self, config: BoatConfig) -> None:
        self.fix: GnssFix | None = None
        self.heading: HeadingReading | None = None
        self.battery: BatteryReading | None = None
        self.rc: RcReading | None = None
        self.depth: DepthReading | None = None
        self.pings: deque[SonarReading] = deque(maxlen=_MOST_PINGS)
        self.health = 0  # bits of MAV_SYS_STATUS_SENSOR that are enabled and well
        self.reboots = 0
        self.dropped = 0
        self._part = config.parts.autopilot_part
        self._config = config.parts
        self._clock = ReceiverClock(self._part.latency_s, _WINDOW_S)
        self._booted_s = 0.0  # latest time by its clock
        self._unix_s: float | None = None  # Unix time less its clock
        self._fix_us = -1
        self._health_s = self._filter_s = -math.inf
        self._filter_fault = True
        self.table: dict[int, Callable[[Message, float], None]] = {
            dialect.MAVLINK_MSG_ID_ATTITUDE: self._on_attitude,
            dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR: self._on_distance,
            dialect.MAVLINK_MSG_ID_EKF_STATUS_REPORT: self._on_filter,
            dialect.MAVLINK_MSG_ID_ESTIMATOR_STATUS: self._on_estimator,
            dialect.MAVLINK_MSG_ID_GPS_RAW_INT: self._on_fix,
            dialect.MAVLINK_MSG_ID_RC_CHANNELS: self._on_channels,
            dialect.MAVLINK_MSG_ID_SYS_STATUS: self._on_health,
            dialect.MAVLINK_MSG_ID_SYSTEM_TIME: self._on_time,
        }

    def _on_attitude(self, message: Message, now_s: float) -> None:
        booted_s = message.time_boot_ms / 1000.0
        if booted_s < self._booted_s - _REBOOT_S:
            self.reboots += 1
            self._health_s = self._filter_s = -math.inf
            self._unix_s = None
        self._booted_s = booted_s
        time_s = self._clock.measured_s(booted_s, now_s)
        yaw, rate, roll, pitch = message.yaw, message.yawspeed, message.roll, message.pitch
        if not math.isfinite(yaw + rate + roll + pitch):
            self.dropped += 1
        elif self.has_heading(now_s):
            self.heading = HeadingReading(time_s, yaw, rate, roll, pitch)

    def has_heading(self, now_s: float) -> bool:
        """Whether its filter has a heading from a compass that it believes."""
        is_known = max(now_s - self._health_s, now_s - self._filter_s) <= _HEALTH_S
        return is_known and not self._filter_fault and self.health & _COMPASS_BITS == _COMPASS_BITS

    def _on_filter(self, message: Message, now_s: float) -> None:
        flags, self._filter_s = message.flags, now_s
        is_aligned = flags & dialect.EKF_ATTITUDE and not flags & dialect.EKF_UNINITIALIZED
        self._filter_fault = not (is_aligned and message.compass_variance < _VARIANCE)  # true for NaN

    def _on_estimator(self, message: Message, now_s: float) -> None:
        """PX4's report."""
        self._filter_s = now_s
        self._filter_fault = not (
            message.flags & dialect.ESTIMATOR_ATTITUDE and message.mag_ratio < _VARIANCE
        )

    def _on_health(self, message: Message, now_s: float) -> None:
        self._health_s = now_s
        self.health = message.onboard_control_sensors_enabled & message.onboard_control_sensors_health
        millivolts, centiamperes = message.voltage_battery, message.current_battery
        if 0 < millivolts < _UNKNOWN_16:  # 0 without a monitor
            current_a = None if centiamperes < 0 else centiamperes / 100.0
            self.battery = BatteryReading(now_s, millivolts / 1000.0, current_a)

    def _on_time(self, message: Message, now_s: float) -> None:  # noqa: ARG002
        unix_s = message.time_unix_usec * 1e-6
        self._unix_s = unix_s - message.time_boot_ms / 1000.0 if unix_s > 0.0 else None

    def _on_fix(self, message: Message, now_s: float) -> None:
        """time_usec is of the autopilot's clock; the message repeats a fix until the next."""
        place, stamp_us = position_from_e7(message.lat, message.lon), message.time_usec
        if place is None or message.fix_type > dialect.GPS_FIX_TYPE_PPP:
            self.dropped += (
                message.fix_type > dialect.GPS_FIX_TYPE_NO_FIX
            )  # before its first fix it is at 0, 0
            return
        if stamp_us == self._fix_us and self.fix is not None and self.fix.fix_type == message.fix_type:
            return
        self._fix_us = stamp_us
        north_m_s = east_m_s = None
        if _UNKNOWN_16 not in (message.vel, message.cog):
            # ArduPilot and PX4 cut off, not round: 5 mm/s would carry the estimate away
            speed_m_s, course_rad = (message.vel + _CUT) / 100.0, math.radians((message.cog + _CUT) / 100.0)
            north_m_s, east_m_s = speed_m_s * math.cos(course_rad), speed_m_s * math.sin(course_rad)
        booted_s = stamp_us * 1e-6
        self.fix = GnssFix(
            self._clock.measured_s(booted_s, now_s) - self._config.gnss.latency_s,
            place,
            message.fix_type,
            0 if message.satellites_visible == _UNKNOWN_8 else message.satellites_visible,
            99.99 if message.eph == _UNKNOWN_16 else message.eph / 100.0,
            north_m_s,
            east_m_s,
            message.alt / 1000.0,
            horizontal_accuracy_m=message.h_acc / 1000.0 or None,  # 0: not known
            unix_time_s=None if self._unix_s is None else self._unix_s + booted_s,
            reset_counter=self.reboots,
            vertical_accuracy_m=message.v_acc / 1000.0 or None,
            speed_accuracy_m_s=message.vel_acc / 1000.0 or None,
        )

    def _on_channels(self, message: Message, now_s: float) -> None:
        """Without a receiver ArduPilot counts no channels. It tells a lost transmitter in SYS_STATUS."""
        count, rssi = min(message.chancount, 18), message.rssi
        if count:
            is_failsafe = not self.health & dialect.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
            channels = tuple(getattr(message, f"chan{number}_raw") for number in range(1, count + 1))
            quality = None if rssi == _UNKNOWN_8 else min(rssi / 254.0, 1.0)
            self.rc = RcReading(now_s, channels, is_failsafe, quality)

    def _on_distance(self, message: Message, now_s: float) -> None:
        orientation, distance_m = message.orientation, message.current_distance / 100.0
        least_m, most_m = message.min_distance / 100.0, message.max_distance / 100.0
        is_found = least_m <= distance_m < most_m and message.signal_quality != 1  # 1: invalid
        if orientation == _DOWN:
            quality = message.signal_quality / 100.0 if message.signal_quality else None  # 0: unknown
            depth_m, sunk_m = distance_m if is_found else None, self._config.depth.transducer_m
            self.depth = DepthReading(now_s, depth_m, None, sunk_m, least_m, most_m, quality)
        elif orientation < _YAW_STEPS:
            bearing_rad = math.remainder(orientation * math.tau / _YAW_STEPS, math.tau)
            found_m = distance_m if is_found else None
            self.pings.append(SonarReading(now_s, bearing_rad, found_m, least_m, most_m))
        else:
            self.dropped += 1
