"""Telemetry of sensors: gyro, compass, power."""

import math

from companion.core.units import clamp
from companion.mavlink.dialect import Message, dialect
from companion.services.telemetry.snapshot import Snapshot

_FIELD = 1000.0  # length of the magnetic field vector


def _imu(now: Snapshot) -> tuple[int, int, int] | None:
    """Yaw rate in mrad/s and direction of north in body axes; None without a compass."""
    reading = now.heading
    if reading is None:
        return None
    rate = reading.yaw_rate_rad_s or 0.0
    ahead, aside = math.cos(reading.heading_rad), -math.sin(reading.heading_rad)
    return round(clamp(rate * 1e3, -32767.0, 32767.0)), round(_FIELD * ahead), round(_FIELD * aside)


def scaled_imu(now: Snapshot) -> Message | None:
    """Only yaw gyro and compass. The field is a direction without a strength."""
    if (imu := _imu(now)) is None:
        return None
    zgyro, xmag, ymag = imu
    return dialect.MAVLink_scaled_imu_message(now.boot_ms, 0, 0, 0, 0, 0, zgyro, xmag, ymag, 0)


def raw_imu(now: Snapshot) -> Message | None:
    """The same numbers: there are no raw ones."""
    if (imu := _imu(now)) is None:
        return None
    zgyro, xmag, ymag = imu
    return dialect.MAVLink_raw_imu_message(now.boot_us, 0, 0, 0, 0, 0, zgyro, xmag, ymag, 0)


def power_status(now: Snapshot) -> Message | None:
    """The pack as the motor rail. The computer's 5 V are not measured: 0."""
    if now.battery is None:
        return None
    flags = dialect.MAV_POWER_STATUS_BRICK_VALID
    if now.vehicle.armed:
        flags |= dialect.MAV_POWER_STATUS_SERVO_VALID
    return dialect.MAVLink_power_status_message(
        0, round(clamp(now.battery.voltage_v * 1e3, 0.0, 65535.0)), flags
    )


def meminfo(now: Snapshot) -> Message | None:
    """Free memory of the computer, if known."""
    free = now.free_memory_bytes
    if free <= 0:
        return None
    return dialect.MAVLink_meminfo_message(0, min(free, 0xFFFF), min(free, 0xFFFFFFFF))
