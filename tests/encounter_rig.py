"""A boat and movers whose motion is well known, for tests of giving way."""

import math

from boat_rig import nav_at
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import HoldCourse
from companion.core.state import NavState
from companion.geofence.fence import Fence
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.scene import Scene

CONFIG = BoatConfig()
NORTH = HoldCourse(0.0, 1.0)
NOW_S = 0.9
ORIGIN = Point(0.0, 0.0)


def mover(
    north_m: float, east_m: float, north_m_s: float = 0.0, east_m_s: float = 0.0, radius_m: float = 0.4
) -> Track:
    """At this place and velocity at NOW_S, known to a centimetre."""
    start = Point(north_m - NOW_S * north_m_s, east_m - NOW_S * east_m_s)
    track = Track(1, 0.0, start, radius_m)
    for look in range(10):
        time_s = 0.1 * look
        track.predict(time_s, 0.0)
        at = Point(start.north_m + north_m_s * time_s, start.east_m + east_m_s * time_s)
        for axis in ((1.0, 0.0), (0.0, 1.0)):
            track.correct(at, *axis, 1e-3)
        if look:
            track.complete_observation(radius_m, 1.0, 0.0)
    track.is_mover = track.is_likely_mover = True
    return track


def boat(
    speed_m_s: float = 1.0, heading_rad: float = 0.0, yaw_rate_rad_s: float = 0.0, at: Point = ORIGIN
) -> NavState:
    return replace(
        nav_at(*at, time_s=NOW_S),
        north_m_s=speed_m_s * math.cos(heading_rad),
        east_m_s=speed_m_s * math.sin(heading_rad),
        surge_m_s=speed_m_s,
        heading_rad=heading_rad,
        yaw_rate_rad_s=yaw_rate_rad_s,
    )


def scene_of(*movers: Track, nav: NavState | None = None, solid: tuple[Point, ...] = ()) -> Scene:
    perception = ObstaclePerception(CONFIG.avoidance)
    perception.tracks.all.extend(movers)
    perception.reach_m = 4.0
    scene = Scene(NORTH, nav or boat(), CONFIG, perception, Fence(), NOW_S)
    scene.solid = scene.obstacles = list(solid)
    return scene
