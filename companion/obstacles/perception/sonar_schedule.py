"""Sector of the swept ranger: where the planner needs to know more.

In open water a fast boat meets only what is nearly ahead. A mover of speed w on a collision course with a
boat of speed v keeps a constant bearing, at most asin(w / v) off the bow: within 30° at the lake boat's
cruise, where the sweep hears ahead every 0.25 s; wider when the boat is slower, and all round below w. A
course that the boat is about to take is looked at, too. A new, isolated echo is observed until it is
classified; movers are kept in view. Among fixed obstacles the boat looks all round.
"""

import math
from typing import Final, NamedTuple

from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.obstacles.perception.occupancy import Beam
from companion.obstacles.perception.track import Track
from companion.obstacles.perception.tracks import ObstacleTracks

_HASTY_S: Final = 3.0  # a boat that covers its sight in less looks again at a single echo at once
_CROSSING_M_S: Final = 0.8  # half a sweep hears ahead every 0.36 s at the speed of 4 m of sight, 1.06 m/s
_AHEAD_RAD: Final = 0.53  # 30°, the narrowest sector ahead: five bearings of 15°, to and fro in 0.48 s
_BESIDE_RAD: Final = 0.27  # a beam on either side of a course about to be taken
_ABOUT_RAD: Final = 0.53  # to either side of a tracked obstacle, to observe the free water beside it
_NEW_LOOKS: Final = 8  # observations after which a track is classified,
_NEW_S: Final = 1.6  # or time
_AGAIN_S: Final = 0.4  # without an echo for this long, it was noise or has gone
_WATCHED_S: Final = 1.2  # how long a mover is searched for
_ABEAM_RAD: Final = 1.6


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
    speed_m_s = math.sqrt(nav.north_m_s * nav.north_m_s + nav.east_m_s * nav.east_m_s)
    if unconfirmed is not None and speed_m_s * _HASTY_S > reach_m:
        echo = unconfirmed.echo
        off = wrap_pi(math.atan2(echo.east_m - nav.east_m, echo.north_m - nav.north_m) - nav.heading_rad)
        return Sector(off, off)
    watched: Track | None = None
    nearest_m, bearing = math.inf, 0.0
    for track in tracks.all:
        unseen_s = now_s - track.seen_s
        if track.is_mover:
            if unseen_s > _WATCHED_S:
                continue
        elif not is_unclassified(track, now_s):
            continue
        distance_m = track.distance_m(nav.point, now_s)
        at = track.point(now_s)
        off = wrap_pi(math.atan2(at.east_m - nav.east_m, at.north_m - nav.north_m) - nav.heading_rad)
        if abs(off) < _ABEAM_RAD and distance_m < nearest_m:
            watched, nearest_m, bearing = track, distance_m, off
    if watched is None:
        if not is_open or speed_m_s <= _CROSSING_M_S:
            return ALL_ROUND
        ahead = max(math.asin(_CROSSING_M_S / speed_m_s), _AHEAD_RAD)
        turn = 0.0 if wished_course_rad is None else wrap_pi(wished_course_rad - nav.heading_rad)
        return Sector(min(-ahead, turn - _BESIDE_RAD), max(ahead, turn + _BESIDE_RAD))
    half = _ABOUT_RAD + math.asin(watched.radius_m / max(nearest_m, 2.0 * watched.radius_m))
    about = Sector(bearing - half, bearing + half)
    if not watched.is_mover:
        return about
    return Sector(min(about.port_rad, -_ABOUT_RAD), max(about.starboard_rad, _ABOUT_RAD))


def is_unclassified(track: Track, now_s: float) -> bool:
    """Whether a track may turn out to move: it is new and isolated, as far as was observed."""
    is_new = (
        track.observations < _NEW_LOOKS
        and now_s - track.created_s < _NEW_S
        and now_s - track.seen_s < _AGAIN_S
    )
    return is_new and not track.is_mover and (track.isolated_count > 0 or track.is_cut_off)
