"""Telemetry of sensors: gyro, compass, power, speed controllers, RC channels."""

import math
from itertools import zip_longest

from companion.autopilot.snapshot import Snapshot
from companion.core.readings import EscReading
from companion.core.units import clamp
from companion.mavlink.dialect import Message, dialect

_MOST_CHANNELS = 18
_UNUSED = 0xFFFF
_BEST_SIGNAL, _UNKNOWN_SIGNAL = 254.0, 0xFF


def _imu(now: Snapshot) -> tuple[int, int, int, int] | None:
    """Yaw rate in mrad/s and corrected magnetic field in body axes in mG; None without a compass.

    The field of a part that gives none is 0, as ArduPilot's without a magnetometer.
    """
    reading, corrector = now.sensors.compass, now.sensors.field
    if reading is None:
        return None
    field = (0.0, 0.0, 0.0)
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


def esc_telemetry_1_to_4(now: Snapshot) -> Message | None:
    """Left and right, as ArduPilot's: °C, 10 mV, 10 mA, mAh, turns a minute. Zeros for one that is silent."""
    escs = now.sensors.escs.readings
    if not any(escs):
        return None
    rows = ((0,) * 6 if one is None else _esc_columns(one) for one in (*escs, None, None))
    return dialect.MAVLink_esc_telemetry_1_to_4_message(*map(list, zip(*rows, strict=True)))


def _esc_columns(reading: EscReading) -> tuple[int, ...]:
    rpm = abs(reading.shaft_rad_s) * 60.0 / math.tau
    values = (100.0 * reading.voltage_v, 100.0 * reading.current_a, reading.consumed_mah, rpm)
    return (
        round(clamp(reading.temperature_c, 0.0, 255.0)),
        *(round(clamp(value, 0.0, 65535.0)) for value in values),
        reading.count & 0xFFFF,
    )


def rc_channels(now: Snapshot) -> Message:
    """The channels as the boat uses them: the receiver's and a station's overrides; the link quality as the
    signal. Without a receiver, the sticks are centred when released.
    """
    sticks, rc = now.vehicle.manual_input, now.config.rc
    radio, signal = sticks.rc, _UNKNOWN_SIGNAL
    if radio.is_fitted and not radio.is_fresh(rc, now.now_s):
        signal = 0
    elif radio.latest is not None and radio.latest.quality is not None:
        signal = round(_BEST_SIGNAL * radio.latest.quality)
    pulses = sticks.channels_us(now.config, now.now_s)[:_MOST_CHANNELS]
    trims = [] if radio.is_fitted else [rc.stick(number).trim_us for number in range(1, 5)]
    shown = [one or trim or _UNUSED for one, trim in zip_longest(pulses, trims, fillvalue=0)]
    unused = [_UNUSED] * (_MOST_CHANNELS - len(shown))
    return dialect.MAVLink_rc_channels_message(now.boot_ms, len(shown), *shown, *unused, signal)
