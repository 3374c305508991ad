"""Telemetry of the boat's status: one function per message, None if not available."""

import re

from companion import __version__
from companion.autopilot.snapshot import Snapshot
from companion.core.geo import position_to_e7
from companion.core.modes import Mode
from companion.core.units import clamp
from companion.mavlink.dialect import Message, build_message, constants, dialect
from companion.vehicle.vehicle import Vehicle

# A real Rover version (major, minor, patch, stage): stations select parameter descriptions by it
_ROVER_VERSION = (4, 6, 0, 0)

_PRESENT: int = sum(
    constants(
        "MAV_SYS_STATUS",
        *("SENSOR_3D_MAG", "SENSOR_GPS", "SENSOR_YAW_POSITION", "SENSOR_XY_POSITION_CONTROL"),
        *("SENSOR_MOTOR_OUTPUTS", "AHRS", "PREARM_CHECK"),
    )
)
_CAPABILITIES: int = sum(
    constants(
        "MAV_PROTOCOL_CAPABILITY",
        *("MISSION_FLOAT", "PARAM_ENCODE_C_CAST", "MISSION_INT", "COMMAND_INT", "FTP", "SET_ATTITUDE_TARGET"),
        *("SET_POSITION_TARGET_LOCAL_NED", "SET_POSITION_TARGET_GLOBAL_INT", "MAVLINK2", "MISSION_FENCE"),
        "MISSION_RALLY",
    )
)


def sys_status(now: Snapshot) -> Message:
    """Health bits. Stations use the PREARM_CHECK bit as "ready to arm"."""
    vehicle, estimate_timeout_s = now.vehicle, now.config.motors.estimate_timeout_s
    nav = now.vehicle.nav
    health = _PRESENT & ~dialect.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
    if not vehicle.failsafes.fence.is_outside:
        # Also set without a fence: MAVProxy reports a breach if this bit is missing
        health |= dialect.MAV_SYS_STATUS_GEOFENCE
    if now.sensors.heading is None:
        health &= ~dialect.MAV_SYS_STATUS_SENSOR_3D_MAG
    if nav is None or nav.heading_age_s > estimate_timeout_s:
        health &= ~(dialect.MAV_SYS_STATUS_SENSOR_3D_MAG | dialect.MAV_SYS_STATUS_SENSOR_YAW_POSITION)
    if now.sensors.fix is None or now.sensors.fix.fix_type < dialect.GPS_FIX_TYPE_3D_FIX:
        health &= ~dialect.MAV_SYS_STATUS_SENSOR_GPS
    if nav is None or nav.position_age_s > estimate_timeout_s:
        health &= ~(dialect.MAV_SYS_STATUS_SENSOR_GPS | dialect.MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL)
        health &= ~dialect.MAV_SYS_STATUS_AHRS
    if vehicle.arming_faults():
        health &= ~dialect.MAV_SYS_STATUS_PREARM_CHECK
    enabled = _PRESENT
    if vehicle.armed:
        health |= dialect.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
    else:
        enabled &= ~dialect.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
    fitted, well = _optional_parts(now)
    enabled |= fitted
    if not now.config.failsafe.rc_enabled:
        enabled &= ~dialect.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
    battery = now.sensors.battery
    current_a = battery.current_a if battery is not None else None
    return build_message(
        "SYS_STATUS",
        onboard_control_sensors_present=_PRESENT | fitted,
        onboard_control_sensors_enabled=enabled,
        onboard_control_sensors_health=health | well,
        load=round(clamp(now.load * 1000.0, 0.0, 1000.0)),
        voltage_battery=0xFFFF if battery is None else round(battery.voltage_v * 1e3),
        current_battery=-1 if current_a is None else round(current_a * 100.0),
        battery_remaining=-1 if battery is None else now.sensors.gauge.percent,
    )


def _optional_parts(now: Snapshot) -> tuple[int, int]:
    """Bits of the optional parts that are fitted, and of those that work."""
    fitted = well = 0
    if now.vehicle.fence.is_active:
        fitted |= dialect.MAV_SYS_STATUS_GEOFENCE
    if now.sensors.has_battery_monitor:
        fitted |= dialect.MAV_SYS_STATUS_SENSOR_BATTERY
        if now.sensors.battery is not None and not now.vehicle.failsafes.pack_is_low:
            well |= dialect.MAV_SYS_STATUS_SENSOR_BATTERY
    if now.sensors.has_gyro:
        fitted |= dialect.MAV_SYS_STATUS_SENSOR_3D_GYRO
        if now.sensors.compass is not None and now.sensors.compass.yaw_rate_rad_s is not None:
            well |= dialect.MAV_SYS_STATUS_SENSOR_3D_GYRO
    radio = now.vehicle.manual_input.rc
    if radio.is_fitted:
        fitted |= dialect.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
        if radio.is_fresh(now.config.rc, now.now_s):
            well |= dialect.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
    if now.sensors.is_sonar_fitted or now.sensors.sweep.latest is not None:
        fitted |= dialect.MAV_SYS_STATUS_SENSOR_PROXIMITY
        if not now.sensors.sweep.is_empty(now.now_s):
            well |= dialect.MAV_SYS_STATUS_SENSOR_PROXIMITY
    return fitted, well


def battery_status(now: Snapshot) -> Message | None:
    """The pack; the total voltage is in the first cell's field. What a silent monitor measured is unknown."""
    if not now.sensors.has_battery_monitor:
        return None
    battery = now.sensors.battery
    current_a = None if battery is None else battery.current_a
    is_low = now.vehicle.failsafes.pack_is_low
    charge_state = dialect.MAV_BATTERY_CHARGE_STATE_OK
    if is_low:
        charge_state = dialect.MAV_BATTERY_CHARGE_STATE_LOW
    elif battery is None:
        charge_state = dialect.MAV_BATTERY_CHARGE_STATE_UNDEFINED
    time_left_s = None if current_a is None else now.sensors.gauge.time_left_s
    return dialect.MAVLink_battery_status_message(
        id=0,
        battery_function=dialect.MAV_BATTERY_FUNCTION_ALL,
        type=dialect.MAV_BATTERY_TYPE_LIPO,
        temperature=0x7FFF,
        voltages=[0xFFFF if battery is None else round(battery.voltage_v * 1e3)] + [0xFFFF] * 9,
        current_battery=-1 if current_a is None else round(current_a * 100.0),
        current_consumed=-1 if current_a is None else round(now.sensors.consumed_mah),
        energy_consumed=-1,
        battery_remaining=-1 if battery is None else now.sensors.gauge.percent,
        time_remaining=0 if time_left_s is None else min(round(time_left_s), 0x7FFFFFFF),  # 0: not known
        charge_state=charge_state,
    )


def fence_status(now: Snapshot) -> Message | None:
    """State of the fence; None without one."""
    if not now.vehicle.fence.is_active:
        return None
    watch = now.vehicle.failsafes.fence
    breach = dialect.FENCE_BREACH_BOUNDARY if watch.is_outside else dialect.FENCE_BREACH_NONE
    return dialect.MAVLink_fence_status_message(
        breach_status=int(watch.is_outside),
        breach_count=min(watch.breaches, 0xFFFF),
        breach_type=breach,
        breach_time=round(watch.breached_s * 1e3) & 0xFFFFFFFF,
    )


def system_time(now: Snapshot) -> Message:
    """The date is 0 until known."""
    return dialect.MAVLink_system_time_message(round(now.unix_s * 1e6), now.boot_ms)


def home_position(now: Snapshot) -> Message | None:
    """Home, if set."""
    home = now.vehicle.home
    if home is None:
        return None
    north_m, east_m = now.vehicle.frame.to_local(home) if now.vehicle.frame is not None else (0.0, 0.0)
    level = [1.0, 0.0, 0.0, 0.0]
    return dialect.MAVLink_home_position_message(
        *position_to_e7(home), 0, north_m, east_m, 0.0, level, 0.0, 0.0, 0.0, now.boot_us
    )


def mission_current(vehicle: Vehicle) -> Message:
    """The present item and mission state. The total excludes home, as the protocol requires."""
    progress = vehicle.progress
    if progress.is_empty:
        state = dialect.MISSION_STATE_NO_MISSION
    elif vehicle.is_returning_from_mission:
        state = dialect.MISSION_STATE_ACTIVE
    elif progress.finished:
        state = dialect.MISSION_STATE_COMPLETE
    elif vehicle.mode is Mode.AUTO and vehicle.armed:
        state = dialect.MISSION_STATE_ACTIVE
    elif progress.has_started:
        state = dialect.MISSION_STATE_PAUSED
    else:
        state = dialect.MISSION_STATE_NOT_STARTED
    in_auto = 1 if vehicle.mode is Mode.AUTO else 2  # mission_mode: 1 in mission mode, 2 suspended
    return dialect.MAVLink_mission_current_message(
        progress.current_seq, progress.last_seq, state, in_auto, *vehicle.list_ids
    )


def extended_sys_state(now: Snapshot) -> Message:  # noqa: ARG001
    """Both undefined, as for Rover."""
    return dialect.MAVLink_extended_sys_state_message(
        dialect.MAV_VTOL_STATE_UNDEFINED, dialect.MAV_LANDED_STATE_UNDEFINED
    )


def _hex_version(version: str) -> str:
    """A version as 8 hexadecimal digits, 2 major, 2 minor, 4 patch: tools read a commit hash here."""
    numbers = [int(number) for number in re.findall(r"\d+", version)[:3]]
    major, minor, patch = [*numbers, 0, 0, 0][:3]
    return f"{major & 0xFF:02x}{minor & 0xFF:02x}{patch & 0xFFFF:04x}"


def autopilot_version(now: Snapshot) -> Message:
    """By these stations select protocols: fence and rally transfers, COMMAND_INT, MISSION_INT."""
    major, minor, patch, stage = _ROVER_VERSION
    return build_message(
        "AUTOPILOT_VERSION",
        capabilities=_CAPABILITIES,
        flight_sw_version=major << 24 | minor << 16 | patch << 8 | stage,
        flight_custom_version=list(_hex_version(__version__).encode("ascii")),
        uid=now.config.identity.system_id,
    )
