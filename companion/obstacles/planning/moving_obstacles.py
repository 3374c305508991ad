"""Avoids moving obstacles: the course and speed closest to the requested ones that keep clear.

Each candidate course and speed is simulated, with the time to turn and to change speed, against obstacles of
constant velocity: the velocity obstacle of P. Fiorini and Z. Shiller, *Motion Planning in Dynamic
Environments Using Velocity Obstacles*, International Journal of Robotics Research 17(7), 1998, with the
boat's own dynamics (J. van den Berg et al., *Reciprocal Collision Avoidance with Acceleration-Velocity
Obstacles*, ICRA 2011). A turn to starboard costs less than one to port, as in the collision regulations;
passing ahead of crossing traffic costs most; slowing down costs little, so crossing traffic passes first and
slower traffic ahead is followed until there is room to overtake.
"""

import math
from typing import Final, NamedTuple

from companion.core.units import wrap_pi
from companion.guidance.speed_profile import steered_speed_m_s
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.scene import Scene

HORIZON_S: Final = 8.0
_STEP_S: Final = 0.25  # about the delay of decisions and motors, too
_TURNS_RAD: Final = (0.0, 0.35, 0.7, 1.05, 1.4, 2.1, -0.35, -0.7, -1.05, -1.4, -2.1)
_PORT_COST: Final = 0.3
_SLOW_COST: Final = 0.6
_ASTERN_COST: Final = 3.0  # an approaching obstacle catches up
_HURRY_COST: Final = 0.8
_NEAR_COST: Final = 6.0  # of passing at no distance: more than any turn
_HIT_COST: Final = 10.0  # in addition, for a collision of the hulls
_HABIT: Final = 2.0  # bonus of the present maneuver
_SURE_SIGMAS: Final = 1.0
_HALF_HULL: Final = 0.45  # of the margin: half the hull length
_TOUCHES: Final = 0.3  # of the margin: hull clearance that counts as a collision
_AHEAD_COST: Final = 2.5  # of passing ahead of crossing traffic
_CROSSES: Final = 0.6  # of its speed
_STILL_M_S: Final = 0.05  # the direction of a slower mover is rounding and sonar noise
_ABAFT_RAD: Final = 2.0
_TURN_LAG_S: Final = 0.6  # delay of the turn
_TURN_GAIN: Final = 1.5  # rad/s for each rad that it points elsewhere
_HURRIES: Final = 3.0  # times the slowest speed with steerage way
_GAINS: Final = 1.5  # of guidance's accel_m_s2
_LOSES: Final = 0.7  # propellers are less efficient astern
_STOPS: Final = 1.4  # with full reverse
_ALIKE_M_S: Final = 0.1


Pose = tuple[float, float, float, float]


class EvasiveManeuver(NamedTuple):
    """A turn from the requested course, positive to starboard, and a speed; negative is astern on the present
    heading.
    """

    turn_rad: float
    speed_m_s: float


def choose_maneuver(
    scene: Scene, course_rad: float, speed_m_s: float, last: EvasiveManeuver | None
) -> EvasiveManeuver | None:
    """The best maneuver; None if no moving obstacle comes near."""
    is_alongside = _is_alongside(scene)
    if not is_alongside and _encroachment(scene, course_rad, speed_m_s)[0] <= 0.0:
        return None
    best, least = EvasiveManeuver(0.0, speed_m_s), math.inf
    crossing = _crossing(scene, course_rad)
    for turn in _TURNS_RAD:
        course = wrap_pi(course_rad + turn)
        if turn and scene.water.room_m(course) < scene.margin_m:
            continue
        turning = abs(turn) + (_PORT_COST if turn < 0.0 else 0.0)
        if turn * crossing > 0.0:
            turning += _AHEAD_COST
        for speed, pacing in _speeds(scene, speed_m_s, turn):
            near, hits = _encroachment(scene, course, speed)
            cost = turning + pacing + _NEAR_COST * near + _HIT_COST * hits
            if last is not None and last.turn_rad == turn and abs(last.speed_m_s - speed) < _ALIKE_M_S:
                cost -= _HABIT
            if cost < least:
                best, least = EvasiveManeuver(turn, speed), cost
    if best != (0.0, speed_m_s):
        return best
    return last if is_alongside else None


def _speeds(scene: Scene, speed_m_s: float, turn: float) -> list[tuple[float, float]]:
    """Candidate speeds on a course, with their costs."""
    least_m_s = scene.config.guidance.min_speed_m_s
    speeds = [(speed_m_s, 0.0)]
    if 0.5 * speed_m_s >= least_m_s:
        speeds.append((0.5 * speed_m_s, 0.5 * _SLOW_COST))
    hurried_m_s = min(_HURRIES * least_m_s, scene.config.speed.cruise_m_s)
    if hurried_m_s > speed_m_s + _ALIKE_M_S:
        speeds.append((hurried_m_s, _HURRY_COST))
    if not turn:
        speeds.append((0.0, _SLOW_COST))
        if scene.room_m(scene.nav.heading_rad + math.pi) > scene.margin_m:
            speeds.append((-least_m_s, _ASTERN_COST))
    return speeds


def clearance_m(mover: Track, scene: Scene) -> float:
    """Distance to keep from the centre of an obstacle, with its size and uncertainty."""
    return scene.margin_m + mover.radius_m + _SURE_SIGMAS * min(mover.sigma_m(scene.now_s), scene.margin_m)


def _crossing(scene: Scene, course_rad: float) -> int:
    """Direction in which the nearest mover crosses the course: 1 to starboard, −1 to port, 0 neither."""
    if not scene.movers:
        return 0
    mover = min(scene.movers, key=lambda one: one.distance_m(scene.here, scene.now_s))
    across_m_s = mover.east_m_s * math.cos(course_rad) - mover.north_m_s * math.sin(course_rad)
    if abs(across_m_s) < max(_CROSSES * mover.speed_m_s, _STILL_M_S):
        return 0
    return 1 if across_m_s > 0.0 else -1


def _is_alongside(scene: Scene) -> bool:
    """Whether a mover is within the clearance and not yet abaft: a turn would swing the stern at it."""
    for mover in scene.movers:
        at = mover.point(scene.now_s)
        north, east = at.north_m - scene.here.north_m, at.east_m - scene.here.east_m
        off_bow = abs(wrap_pi(math.atan2(east, north) - scene.nav.heading_rad))
        if off_bow < _ABAFT_RAD and math.hypot(north, east) < clearance_m(mover, scene):
            return True
    return False


def _encroachment(scene: Scene, course_rad: float, speed_m_s: float) -> tuple[float, float]:
    """How far the nearest mover comes within the clearance, 0 not at all to 1; and the same for the hulls."""
    way = _predicted_track(scene, course_rad, speed_m_s)
    worst, hits = 0.0, 0.0
    for mover in scene.movers:
        room_m, hull_m = clearance_m(mover, scene), mover.radius_m + _TOUCHES * scene.margin_m
        near, hit = 0.0, 0.0
        for north_m_s, east_m_s in ((mover.north_m_s, mover.east_m_s), _collision_velocity(mover, scene)):
            before, nearest = _closest_m(mover, scene, way, north_m_s, east_m_s)
            if nearest < min(room_m, before):  # one that is near and recedes is no danger
                near += 0.5 * (1.0 - nearest / room_m)
                hit += 0.5 * max(1.0 - nearest / hull_m, 0.0)
        worst, hits = max(worst, near), max(hits, hit)
    return worst, hits


def _closest_m(
    mover: Track, scene: Scene, way: list[Pose], north_m_s: float, east_m_s: float
) -> tuple[float, float]:
    """Present distance and least distance of any part of the hull along the track, for a mover of this
    velocity.
    """
    at = mover.point(scene.now_s)
    north, east = at.north_m - scene.here.north_m, at.east_m - scene.here.east_m
    half_m = _HALF_HULL * scene.margin_m
    now_m, nearest = math.hypot(north, east) - half_m, math.inf
    for boat_n, boat_e, ahead_n, ahead_e in way:
        north += _STEP_S * north_m_s
        east += _STEP_S * east_m_s
        to_n, to_e = north - boat_n, east - boat_e
        along = to_n * ahead_n + to_e * ahead_e
        across = to_e * ahead_n - to_n * ahead_e
        beyond = max(abs(along) - half_m, 0.0)
        nearest = min(nearest, math.sqrt(beyond * beyond + across * across))
    return now_m, nearest


def _collision_velocity(mover: Track, scene: Scene) -> tuple[float, float]:
    """The mover's velocity, north and east, with its crossing component reduced by a standard deviation:
    constant bearing means collision, and the sonar measures that component worst.
    """
    at, nav = mover.point(scene.now_s), scene.nav
    north, east = at.north_m - scene.here.north_m, at.east_m - scene.here.east_m
    distance = max(math.hypot(north, east), 1e-6)
    across_n, across_e = -east / distance, north / distance
    crosses = (mover.north_m_s - nav.north_m_s) * across_n + (mover.east_m_s - nav.east_m_s) * across_e
    less = math.copysign(min(abs(crosses), mover.pace_sigma_m_s(across_n, across_e)), crosses)
    return mover.north_m_s - less * across_n, mover.east_m_s - less * across_e


def _predicted_track(scene: Scene, course_rad: float, speed_m_s: float) -> list[Pose]:
    """Predicted positions relative to here, with the bow's direction, at each step up to the horizon."""
    nav, handling, guidance = scene.nav, scene.config.handling, scene.config.guidance
    heading, surge = nav.heading_rad, nav.surge_m_s
    least_radius_m = scene.config.drive.least_radius_m
    fastest, turning = handling.turn_rate_rad_s, nav.yaw_rate_rad_s
    takes_up = 1.0 - math.exp(-_STEP_S / _TURN_LAG_S)
    gains, loses = _GAINS * guidance.accel_m_s2 * _STEP_S, _LOSES * guidance.accel_m_s2 * _STEP_S
    current_n, current_e = nav.current_north_m_s, nav.current_east_m_s
    target = heading if speed_m_s <= 0.0 else scene.heading_for_rad(course_rad, speed_m_s)
    if speed_m_s <= 0.0:
        loses = _STOPS * guidance.accel_m_s2 * _STEP_S
    north, east = 0.0, 0.0
    way: list[Pose] = []
    for step in range(round(HORIZON_S / _STEP_S)):
        error = wrap_pi(target - heading) if step else 0.0  # motor delay
        if least_radius_m > 0.0:
            fastest = min(handling.turn_rate_rad_s, abs(surge) / least_radius_m)
        turning += takes_up * (min(max(_TURN_GAIN * error, -fastest), fastest) - turning)
        heading += turning * _STEP_S
        wanted = steered_speed_m_s(speed_m_s, error, scene.config) if speed_m_s > 0.0 else speed_m_s
        surge += min(max(wanted - surge, -loses), gains)
        ahead_n, ahead_e = math.cos(heading), math.sin(heading)
        aside = (
            current_e * ahead_n - current_n * ahead_e
        )  # the current along the bow is part of the speed over ground
        north += _STEP_S * (surge * ahead_n - aside * ahead_e)
        east += _STEP_S * (surge * ahead_e + aside * ahead_n)
        way.append((north, east, ahead_n, ahead_e))
    return way
