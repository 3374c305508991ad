"""Telemetry of obstacles."""

import math

from companion.autopilot.snapshot import Snapshot
from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.units import wrap_pi
from companion.mavlink.dialect import Message, build_message, dialect
from companion.obstacles.perception.sonar_scan import SECTOR_RAD, SECTORS, UNKNOWN_CM


def obstacle_distance(now: Snapshot) -> Message | None:
    """Latest sweep and remembered obstacles, 72 sectors clockwise from the bow; None without pings."""
    sweep = now.sensors.sweep
    if sweep is None or sweep.latest is None or sweep.is_empty(now.now_s):
        return None
    distances, farthest_cm = sweep.distances_cm(now.now_s)
    for sector, cm in _remembered_cm(now).items():
        if cm <= farthest_cm:
            distances[sector] = min(distances[sector], cm)
    return build_message(
        "OBSTACLE_DISTANCE",
        time_usec=now.boot_us,
        sensor_type=dialect.MAV_DISTANCE_SENSOR_ULTRASOUND,
        distances=distances,
        increment=round(math.degrees(SECTOR_RAD)),
        min_distance=round(100.0 * sweep.latest.min_range_m),
        max_distance=farthest_cm,
        increment_f=math.degrees(SECTOR_RAD),
        frame=dialect.MAV_FRAME_BODY_FRD,
    )


def _remembered_cm(now: Snapshot) -> dict[int, int]:
    """The nearest solid cell in each sector."""
    nearest: dict[int, int] = {}
    perception, nav = now.guidance.perception, now.vehicle.nav
    if perception is None or nav is None:
        return nearest
    here, half_m = nav.point, 0.5 * perception.occupancy.cell_m
    for thing in perception.solid():
        distance = max(distance_m(here, thing), half_m)
        centre = wrap_pi(bearing_rad(here, thing) - nav.heading_rad)
        half = math.atan2(half_m, distance)
        for sector in range(round((centre - half) / SECTOR_RAD), round((centre + half) / SECTOR_RAD) + 1):
            cm = min(round(100.0 * distance), UNKNOWN_CM - 1)
            nearest[sector % SECTORS] = min(nearest.get(sector % SECTORS, UNKNOWN_CM), cm)
    return nearest


def obstacle_distance_3d(now: Snapshot) -> Message | None:
    """The nearest track, ahead and to starboard, with its number."""
    perception, nav = now.guidance.perception, now.vehicle.nav
    known = [] if perception is None else perception.tracks.known(now.now_s)
    if perception is None or nav is None or not known:
        return None
    here = nav.point
    track = min(known, key=lambda one: one.distance_m(here, now.now_s))
    at: Point = track.point(now.now_s)
    north, east = at.north_m - here.north_m, at.east_m - here.east_m
    c, s = math.cos(nav.heading_rad), math.sin(nav.heading_rad)
    return build_message(
        "OBSTACLE_DISTANCE_3D",
        time_boot_ms=now.boot_ms,
        sensor_type=dialect.MAV_DISTANCE_SENSOR_ULTRASOUND,
        frame=dialect.MAV_FRAME_BODY_FRD,
        obstacle_id=track.number & 0xFFFF,
        x=north * c + east * s,
        y=east * c - north * s,
        max_distance=perception.reach_m,
    )
