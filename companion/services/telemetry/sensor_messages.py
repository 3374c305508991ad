"""Telemetry of sensors: gyro, compass, power, RC channels."""

import math

from companion.core.units import clamp
from companion.mavlink.dialect import Message, dialect
from companion.services.telemetry.snapshot import Snapshot

_MOST_CHANNELS = 18
_CENTRE_US, _SPAN_US = 1500.0, 500.0
_UNUSED = 0xFFFF
_BEST_SIGNAL, _UNKNOWN_SIGNAL = 254.0, 0xFF
_FIELD = 1000.0  # length of the magnetic field vector


def _imu(now: Snapshot) -> tuple[int, int, int, int] | None:
    """Yaw rate in mrad/s and magnetic field in body axes; None without a compass.

    The field is a magnetometer's, corrected, in mG; of other parts it is a direction without a strength.
    """
    reading, corrector = now.sensors.compass, now.sensors.field
    if reading is None:
        return None
    heading_rad = reading.heading_rad
    field = (_FIELD * math.cos(heading_rad), -_FIELD * math.sin(heading_rad), 0.0)
    if corrector is not None and reading.field_mg is not None:
        field = corrector.correct(reading.field_mg)
    rate = 1e3 * (reading.yaw_rate_rad_s or 0.0)
    zgyro, x, y, z = (round(clamp(one, -32767.0, 32767.0)) for one in (rate, *field))
    return zgyro, x, y, z


def scaled_imu(now: Snapshot) -> Message | None:
    """Only yaw gyro and compass."""
    if (imu := _imu(now)) is None:
        return None
    return dialect.MAVLink_scaled_imu_message(now.boot_ms, 0, 0, 0, 0, 0, *imu)


def raw_imu(now: Snapshot) -> Message | None:
    """The same numbers: there are no raw ones."""
    if (imu := _imu(now)) is None:
        return None
    return dialect.MAVLink_raw_imu_message(now.boot_us, 0, 0, 0, 0, 0, *imu)


def power_status(now: Snapshot) -> Message | None:
    """The pack as the motor rail. The computer's 5 V are not measured: 0."""
    if now.sensors.battery is None:
        return None
    flags = dialect.MAV_POWER_STATUS_BRICK_VALID
    if now.vehicle.armed:
        flags |= dialect.MAV_POWER_STATUS_SERVO_VALID
    return dialect.MAVLink_power_status_message(
        0, round(clamp(now.sensors.battery.voltage_v * 1e3, 0.0, 65535.0)), flags
    )


def meminfo(now: Snapshot) -> Message | None:
    """Free memory of the computer, if known."""
    free = now.free_memory_bytes
    if free <= 0:
        return None
    return dialect.MAVLink_meminfo_message(0, min(free, 0xFFFF), min(free, 0xFFFFFFFF))


def rc_channels(now: Snapshot) -> Message:
    """The receiver's channels (none while RC is lost), and the link quality as the signal.

    Manual input from a station replaces the transmitter's sticks. Without a receiver it is all there is,
    centred when released.
    """
    sticks, config = now.vehicle.manual_input, now.config
    radio, rc, reading = sticks.rc, config.rc, sticks.rc.latest
    pulses, signal = [], _UNKNOWN_SIGNAL
    if reading is not None and radio.is_fresh(rc, now.now_s):
        pulses = list(reading.channels_us[:_MOST_CHANNELS])
        if reading.quality is not None:
            signal = round(_BEST_SIGNAL * reading.quality)
    elif radio.is_fitted:
        signal = 0
    if sticks.has_station(config, now.now_s) or not radio.is_fitted:
        throttle, steering = sticks.throttle_and_steering(config, now.now_s)
        pulses += [round(_CENTRE_US)] * (4 - len(pulses))
        pulses[rc.steering_channel - 1] = round(_CENTRE_US + _SPAN_US * steering)
        pulses[rc.throttle_channel - 1] = round(_CENTRE_US + _SPAN_US * throttle)
    unused = [_UNUSED] * (_MOST_CHANNELS - len(pulses))
    return dialect.MAVLink_rc_channels_message(now.boot_ms, len(pulses), *pulses, *unused, signal)
