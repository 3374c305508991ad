"""Where the ranger is to look: ahead when the boat goes fast, and at what may be coming.

A sweep of half the horizon comes by only every second and a half, in which a boat and what comes towards it
close by metres. What has just been heard, alone in free water, is looked at again and again until it is known
whether it moves; what moves is kept in view. What is aside of a boat under way was ahead of it before.
"""

import math
from typing import Final, NamedTuple

from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.obstacles.perception.track import Track
from companion.obstacles.perception.tracks import ObstacleTracks

_FAST_S: Final = 8.0  # a boat that covers its sight within this goes fast
_AHEAD_RAD: Final = 1.06  # looked at then, to either side
_ABOUT_RAD: Final = 0.53  # to either side of what is watched, so that free water is heard beside it
_NEW_LOOKS: Final = 8  # after so many it is known whether a thing moves,
_NEW_S: Final = 1.6  # or after this time
_AGAIN_S: Final = 0.4  # what is not heard again within this was a ghost, or is gone
_WATCHED_S: Final = 1.2  # what moves is looked for so long
_ABEAM_RAD: Final = 1.6


class Sector(NamedTuple):
    """From port to starboard, from the bow, clockwise."""

    port_rad: float
    starboard_rad: float


ALL_ROUND: Final = Sector(-math.pi, math.pi)
_AHEAD: Final = Sector(-_AHEAD_RAD, _AHEAD_RAD)


def choose_sector(
    nav: NavState, tracks: ObstacleTracks, reach_m: float, now_s: float, *, is_open: bool
) -> Sector:
    """Where to look next. is_open: nothing surely lies there; else what is aside is not lost sight of."""
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
        if not is_open:
            return ALL_ROUND
        speed_m_s = math.sqrt(nav.north_m_s * nav.north_m_s + nav.east_m_s * nav.east_m_s)
        return _AHEAD if speed_m_s * _FAST_S > reach_m else ALL_ROUND
    half = _ABOUT_RAD + math.asin(watched.radius_m / max(nearest_m, 2.0 * watched.radius_m))
    about = Sector(bearing - half, bearing + half)
    if not watched.is_mover:
        return about
    return Sector(min(about.port_rad, -_ABOUT_RAD), max(about.starboard_rad, _ABOUT_RAD))


def is_unclassified(track: Track, now_s: float) -> bool:
    """Whether it may turn out to move: it is new, and stands alone as far as was seen."""
    is_new = (
        track.observations < _NEW_LOOKS
        and now_s - track.created_s < _NEW_S
        and now_s - track.seen_s < _AGAIN_S
    )
    return is_new and not track.is_mover and (track.isolated_count > 0 or track.is_cut_off)
