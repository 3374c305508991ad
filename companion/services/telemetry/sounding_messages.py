"""Telemetry of ranger and depth sounder: one function per message, None if not available."""

import math
from typing import Final

from companion.autopilot.snapshot import Snapshot
from companion.core.geo import position_to_e7
from companion.core.units import clamp, wrap_two_pi
from companion.mavlink.dialect import Message, build_message, constants, dialect

_RANGER_ID, _SOUNDER_ID = 0, 1
_LASER, _ULTRASOUND = constants("MAV_DISTANCE_SENSOR", "LASER", "ULTRASOUND")
_SOUNDER_BEAM_RAD: Final = math.radians(30.0)  # Ping1D at -3 dB; others have 10 to 45 degrees


def distance_sensor(now: Snapshot) -> list[Message]:
    """The ranger, then the depth sounder."""
    return [message for message in (_ranger_distance(now), _sounder_distance(now)) if message is not None]


def _ranger_distance(now: Snapshot) -> Message | None:
    """The latest ping. Other bearings than multiples of 45° use a custom orientation."""
    ping = now.sensors.sonar
    if ping is None:
        return None
    half_yaw_rad = 0.5 * ping.bearing_rad
    range_m = ping.max_range_m + 0.01 if ping.range_m is None else ping.range_m
    return dialect.MAVLink_distance_sensor_message(
        time_boot_ms=round(ping.time_s * 1e3) & 0xFFFFFFFF,
        min_distance=_cm(ping.min_range_m),
        max_distance=_cm(ping.max_range_m),
        current_distance=_cm(range_m),
        type=_LASER if now.config.parts.sonar.is_laser else _ULTRASOUND,
        id=_RANGER_ID,
        orientation=_orientation(ping.bearing_rad),
        covariance=0xFF,
        horizontal_fov=now.config.avoidance.beam_rad,
        vertical_fov=now.config.avoidance.beam_rad,
        quaternion=[math.cos(half_yaw_rad), 0.0, 0.0, math.sin(half_yaw_rad)],
        signal_quality=0,
    )


def _orientation(bearing_rad: float) -> int:
    """MAV_SENSOR_ROTATION's yaws in eighths of a turn, or CUSTOM with the quaternion."""
    eighths = wrap_two_pi(bearing_rad) / (math.pi / 4.0)
    nearest = round(eighths)
    return nearest % 8 if abs(eighths - nearest) < 1e-6 else dialect.MAV_SENSOR_ROTATION_CUSTOM


def _sounder_distance(now: Snapshot) -> Message | None:
    """The latest sounding, downwards from the transducer."""
    sounding = now.sensors.depth
    if sounding is None:
        return None
    depth_m = sounding.max_range_m + 0.01 if sounding.depth_m is None else sounding.depth_m
    return build_message(
        "DISTANCE_SENSOR",
        time_boot_ms=round(sounding.time_s * 1e3) & 0xFFFFFFFF,
        min_distance=_cm(sounding.min_range_m),
        max_distance=_cm(sounding.max_range_m),
        current_distance=_cm(depth_m),
        type=_ULTRASOUND,
        id=_SOUNDER_ID,
        orientation=dialect.MAV_SENSOR_ROTATION_PITCH_270,
        covariance=0xFF,
        horizontal_fov=_SOUNDER_BEAM_RAD,
        vertical_fov=_SOUNDER_BEAM_RAD,
        signal_quality=0 if sounding.quality is None else max(round(100.0 * sounding.quality), 1),
    )


def water_depth(now: Snapshot) -> Message | None:
    """The latest sounding with the boat's position. As Rover's, it is from the transducer down."""
    sounding, vehicle = now.sensors.depth, now.vehicle
    if sounding is None or vehicle.nav is None or vehicle.frame is None:
        return None
    lat_e7, lon_e7 = position_to_e7(vehicle.frame.to_global(vehicle.nav.point))
    return build_message(
        "WATER_DEPTH",
        time_boot_ms=round(sounding.time_s * 1e3) & 0xFFFFFFFF,
        id=_SOUNDER_ID,
        healthy=int(sounding.depth_m is not None),
        lat=lat_e7,
        lng=lon_e7,
        yaw=vehicle.nav.heading_rad,
        distance=sounding.depth_m or 0.0,
        temperature=sounding.temperature_c or 0.0,
    )


def _cm(metres: float) -> int:
    return round(clamp(metres * 100.0, 0.0, 65535.0))
