"""Telemetry of motion: one function per message, None if not available."""

import math

from companion.autopilot.snapshot import Snapshot
from companion.core.geo import LatLon, bearing_rad, distance_m, position_to_e7
from companion.core.readings import GnssFix
from companion.core.units import clamp, wrap_two_pi
from companion.mavlink.dialect import Message, build_message, dialect

# POSITION_TARGET_TYPEMASK: height, vertical speed, accelerations and yaw rate mean nothing here
_POSITION_AND_VELOCITY = 0b1001_1110_0100


# Limits of the fields: a cold receiver reports arbitrary values
_INT32_MAX, _UINT32_MAX = 0x7FFFFFFF, 0xFFFFFFFF
_OLDEST_CORRECTIONS_S = 120.0  # of a u-blox receiver; it reports no greater age


def _int16(value: float) -> int:
    return round(clamp(value, -32767.0, 32767.0))


def heading_cdeg(heading_rad: float) -> int:
    """Hundredths of a degree, 0 to 35999."""
    return round(math.degrees(wrap_two_pi(heading_rad)) * 100.0) % 36000


def attitude(now: Snapshot) -> Message | None:
    """Roll and pitch are 0: the estimate has none."""
    if now.vehicle.nav is None:
        return None
    return dialect.MAVLink_attitude_message(
        now.boot_ms, 0.0, 0.0, now.vehicle.nav.heading_rad, 0.0, 0.0, now.vehicle.nav.yaw_rate_rad_s
    )


def attitude_quaternion(now: Snapshot) -> Message | None:
    """The same as ATTITUDE, as a rotation."""
    if (nav := now.vehicle.nav) is None:
        return None
    half_rad = 0.5 * nav.heading_rad
    rotation = math.cos(half_rad), 0.0, 0.0, math.sin(half_rad)
    return dialect.MAVLink_attitude_quaternion_message(now.boot_ms, *rotation, 0.0, 0.0, nav.yaw_rate_rad_s)


def global_position_int(now: Snapshot) -> Message | None:
    """The estimate, not the receiver's fix."""
    nav, frame = now.vehicle.nav, now.vehicle.frame
    if nav is None or frame is None:
        return None
    velocity_cm_s = _int16(nav.north_m_s * 100.0), _int16(nav.east_m_s * 100.0), 0
    place_e7 = position_to_e7(frame.to_global(nav.point))
    return dialect.MAVLink_global_position_int_message(
        now.boot_ms, *place_e7, 0, 0, *velocity_cm_s, heading_cdeg(nav.heading_rad)
    )


def local_position_ned(now: Snapshot) -> Message | None:
    """Relative to the frame's origin."""
    nav = now.vehicle.nav
    if nav is None or now.vehicle.frame is None:
        return None
    return dialect.MAVLink_local_position_ned_message(
        now.boot_ms, nav.north_m, nav.east_m, 0.0, nav.north_m_s, nav.east_m_s, 0.0
    )


def global_origin(origin: LatLon, time_us: int = 0) -> Message:
    """The origin of local positions."""
    return dialect.MAVLink_gps_global_origin_message(*position_to_e7(origin), 0, time_us)


def gps_global_origin(now: Snapshot) -> Message | None:
    """The origin of LOCAL_POSITION_NED, once set."""
    return None if now.vehicle.frame is None else global_origin(now.vehicle.frame.origin, now.boot_us)


def position_target_global_int(now: Snapshot) -> Message | None:
    """The target position and speed; None without a target."""
    target, demand = now.vehicle.destination, now.guidance.demand
    if target is None or demand is None:
        return None
    lat_e7, lon_e7 = position_to_e7(target)
    return build_message(
        "POSITION_TARGET_GLOBAL_INT",
        time_boot_ms=now.boot_ms,
        coordinate_frame=dialect.MAV_FRAME_GLOBAL,
        type_mask=_POSITION_AND_VELOCITY,
        lat_int=lat_e7,
        lon_int=lon_e7,
        vx=demand.speed_m_s * math.cos(demand.heading_rad),
        vy=demand.speed_m_s * math.sin(demand.heading_rad),
        yaw=demand.heading_rad,
    )


def vfr_hud(now: Snapshot) -> Message | None:
    """Ground speed, heading and throttle."""
    nav = now.vehicle.nav
    if nav is None:
        return None
    speed_m_s = math.hypot(nav.north_m_s, nav.east_m_s)
    throttle = round(50.0 * abs(now.command.left + now.command.right))
    heading_deg = round(math.degrees(wrap_two_pi(nav.heading_rad))) % 360
    return dialect.MAVLink_vfr_hud_message(speed_m_s, speed_m_s, heading_deg, throttle, 0.0, 0.0)


def gps_raw_int(now: Snapshot) -> Message | None:
    """The receiver's fix; "no fix" without one."""
    fix = now.sensors.fix
    if fix is None:
        return dialect.MAVLink_gps_raw_int_message(
            now.boot_us, dialect.GPS_FIX_TYPE_NO_GPS, 0, 0, 0, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0
        )
    if fix.north_m_s is None or fix.east_m_s is None:
        speed_cm_s, course_cdeg = 0xFFFF, 0xFFFF
    else:
        speed_cm_s = min(round(100.0 * math.hypot(fix.north_m_s, fix.east_m_s)), 0xFFFE)
        course_cdeg = heading_cdeg(math.atan2(fix.east_m_s, fix.north_m_s))
    lat_e7, lon_e7 = position_to_e7(fix.position)
    return build_message(
        "GPS_RAW_INT",
        time_usec=round(fix.time_s * 1e6),
        fix_type=fix.fix_type,
        lat=lat_e7,
        lon=lon_e7,
        alt=round(clamp(fix.altitude_m * 1e3, -_INT32_MAX, _INT32_MAX)),
        eph=round(min(fix.hdop * 100.0, 65534.0)),
        epv=0xFFFF,
        vel=speed_cm_s,
        cog=course_cdeg,
        satellites_visible=min(fix.satellites, 255),  # which is: not known
        h_acc=_thousandths(fix.horizontal_accuracy_m),
        v_acc=_thousandths(fix.vertical_accuracy_m),
        vel_acc=_thousandths(fix.speed_accuracy_m_s),
        hdg_acc=_e5_degrees(fix.heading_accuracy_rad),
        yaw=_antenna_yaw_cdeg(fix, now.config.parts.compass.driver == "gnss"),
    )


def gps_rtk(now: Snapshot) -> Message | None:
    """The time of the corrections in use; None without them. The age is that of the receiver, rounded up."""
    fix = now.sensors.fix
    if fix is None or fix.correction_age_s is None:
        return None
    corrected_s = max(fix.time_s - min(fix.correction_age_s, _OLDEST_CORRECTIONS_S), 0.0)
    return build_message(
        "GPS_RTK",
        time_last_baseline_ms=round(corrected_s * 1e3) & _UINT32_MAX,
        rtk_health=int(fix.fix_type >= dialect.GPS_FIX_TYPE_DGPS),
        nsats=min(fix.satellites, 255),
        baseline_coords_type=dialect.RTK_BASELINE_COORDINATE_SYSTEM_NED,
        accuracy=_thousandths(fix.horizontal_accuracy_m),
    )


def _thousandths(value: float | None) -> int:
    """0: not reported."""
    return 0 if value is None else round(clamp(value * 1e3, 0.0, _UINT32_MAX))


def _e5_degrees(angle_rad: float | None) -> int:
    return 0 if angle_rad is None else round(clamp(math.degrees(angle_rad) * 1e5, 0.0, _UINT32_MAX))


def _antenna_yaw_cdeg(fix: GnssFix, is_fitted: bool) -> int:
    """GPS_RAW_INT.yaw: 0 without a second antenna, 65535 while there is no heading, 36000 for north."""
    if fix.heading_rad is None:
        return 0xFFFF if is_fitted else 0
    return heading_cdeg(fix.heading_rad) or 36000


def nav_controller_output(now: Snapshot) -> Message | None:
    """Guidance output. wp_dist: along the way; xtrack_error is positive to the right of the line."""
    nav, demand = now.vehicle.nav, now.guidance.demand
    if nav is None:
        return None
    if demand is None:
        heading_deg = _int16(math.degrees(nav.heading_rad))
        return build_message("NAV_CONTROLLER_OUTPUT", nav_bearing=heading_deg, target_bearing=heading_deg)
    target_deg = heading_deg = _int16(math.degrees(demand.heading_rad))
    left_m = now.vehicle.way_left_m
    if now.vehicle.frame is not None and (waypoint := now.vehicle.destination) is not None:
        target = now.vehicle.frame.to_local(waypoint)
        target_deg = _int16(math.degrees(bearing_rad(nav.point, target)))
        if demand.distance_m == 0.0:  # it gives way to an obstacle
            left_m = left_m or distance_m(nav.point, target)
    return build_message(
        "NAV_CONTROLLER_OUTPUT",
        nav_bearing=heading_deg,
        target_bearing=target_deg,
        wp_dist=round(min(left_m or demand.distance_m, 65535.0)),
        aspd_error=demand.speed_m_s - math.hypot(nav.north_m_s, nav.east_m_s),
        xtrack_error=demand.cross_track_m,
    )


def servo_output_raw(now: Snapshot) -> Message:
    """Motors, rudder and the payload's servos as pulse widths."""
    return dialect.MAVLink_servo_output_raw_message(now.boot_us & 0xFFFFFFFF, 0, *now.output_us)


def pid_tuning(now: Snapshot) -> Message | None:
    """The heading PID; None while it is inactive."""
    pid, demand, nav = now.guidance.helm.heading_pid, now.guidance.demand, now.vehicle.nav
    if pid is None or demand is None or nav is None:
        return None
    return dialect.MAVLink_pid_tuning_message(
        axis=dialect.PID_TUNING_YAW,
        desired=math.degrees(demand.heading_rad),
        achieved=math.degrees(nav.heading_rad),
        FF=pid.ff,
        P=pid.p,
        I=pid.i,
        D=pid.d,
    )
