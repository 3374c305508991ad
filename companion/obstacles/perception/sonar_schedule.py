"""Sector of the swept ranger: where the planner needs to know more.

In open water a fast boat meets only what is nearly ahead. A mover of speed w on a collision course with a
boat of speed v keeps a constant bearing, at most asin(w / v) off the bow: within 30° at the lake boat's
cruise, where the sweep hears ahead every 0.25 s; wider when the boat is slower, and all round below w. A
course that the boat is about to take is looked at, too. A new, isolated echo is observed until it is
classified; movers are kept in view. Among fixed obstacles the boat looks all round.
"""

import math
from typing import Final, NamedTuple

from companion.core.geo import Point, bearing_rad
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.obstacles.perception.occupancy import SWEEP_S, Beam
from companion.obstacles.perception.track import Track
from companion.obstacles.perception.tracks import SAME_PASS_S, ObstacleTracks

_HASTY_S: Final = 3.0  # a boat that covers its sight in less looks again at a single echo at once
_CROSSING_M_S: Final = 0.8  # half a sweep hears ahead every 0.36 s at the speed of 4 m of sight, 1.2 m/s
AHEAD_RAD: Final = 0.53  # two bearings of 15° to either side: ahead, or to see the water beside a track
_BESIDE_RAD: Final = 0.27  # a beam on either side of a course about to be taken
_ABEAM_RAD: Final = 1.6  # the servo's reach, and what was ahead before is abaft it


class Sector(NamedTuple):
    """From port to starboard, relative to the bow, clockwise."""

    port_rad: float
    starboard_rad: float


ALL_ROUND: Final = Sector(-math.pi, math.pi)


def choose_sector(
    nav: NavState,
    tracks: ObstacleTracks,
    reach_m: float,
    now_s: float,
    unconfirmed: Beam | None = None,
    wished_course_rad: float | None = None,
    *,
    is_open: bool,
) -> Sector:
    """The next sector. unconfirmed: an echo that a fast boat observes again at once. wished_course_rad: about
    to be taken. is_open: there is no solid cell; otherwise the whole sweep is kept.
    """
    speed_m_s = math.hypot(nav.north_m_s, nav.east_m_s)
    if unconfirmed is not None and speed_m_s * _HASTY_S > reach_m:
        off = _off_bow_rad(nav, unconfirmed.echo)
        return Sector(off, off)
    watched = [track for track in tracks.all if _is_watched(track, nav, now_s)]
    if watched:
        nearest = min(watched, key=lambda track: track.distance_m(nav.point, now_s))
        return _about(nearest, nav, now_s)
    if not is_open or speed_m_s <= _CROSSING_M_S:
        return ALL_ROUND
    ahead = max(math.asin(_CROSSING_M_S / speed_m_s), AHEAD_RAD)
    turn = 0.0 if wished_course_rad is None else wrap_pi(wished_course_rad - nav.heading_rad)
    return Sector(min(-ahead, turn - _BESIDE_RAD), max(ahead, turn + _BESIDE_RAD))


def _is_watched(track: Track, nav: NavState, now_s: float) -> bool:
    """Movers, and what is new and seen at each pass, before the beam."""
    if abs(_off_bow_rad(nav, track.point(now_s))) >= _ABEAM_RAD:
        return False
    if track.is_mover:
        return now_s - track.seen_s <= SWEEP_S
    is_new = now_s - track.created_s < SWEEP_S and now_s - track.seen_s < SAME_PASS_S
    return is_new and track.may_move(now_s)


def _about(track: Track, nav: NavState, now_s: float) -> Sector:
    """The sector about a track; of a mover, the water ahead as well."""
    bearing = _off_bow_rad(nav, track.point(now_s))
    distance_m = max(track.distance_m(nav.point, now_s), 2.0 * track.radius_m)
    half = AHEAD_RAD + math.asin(track.radius_m / distance_m)
    if not track.is_mover:
        return Sector(bearing - half, bearing + half)
    return Sector(min(bearing - half, -AHEAD_RAD), max(bearing + half, AHEAD_RAD))


def _off_bow_rad(nav: NavState, place: Point) -> float:
    return wrap_pi(bearing_rad(nav.point, place) - nav.heading_rad)
