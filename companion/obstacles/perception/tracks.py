"""Groups echoes into obstacles and tracks them from sweep to sweep.

Echoes of neighbouring beams at similar ranges form one group. A long group is shore and stays in the grid
only (`occupancy.py`). A short one is associated with a track by its deviation along and across the beam. A
group with free water on either side is isolated; otherwise it may be the end of a longer obstacle, and the
visible end of a shore moves along with the boat.
"""

import math

from companion.core.geo import Point
from companion.obstacles.perception.occupancy import Beam, Occupancy
from companion.obstacles.perception.track import Track

MAX_TRACKS = 16
LOST_S = 4.0  # tracks not observed for this long are removed; a full sweep takes 1.4 s
_GATE_SIGMAS = 3.0
_CORRELATED = 1.5  # the position of the echo within the beam is not independent between pings
_SAME_PASS_S = 0.4  # longest time between echoes of neighbouring beams
_FREE_BESIDE = 1.5  # of the scale: a neighbouring echo farther off belongs to something else
_SAME_THING = 0.6  # of the scale: largest difference in range within a group
_LONGEST = 2.0  # of the scale: a longer group is shore
_AGAIN_S = 0.4  # a mover is observed again within this, as the sonar follows it
_RANGE_SIGMA = 0.05  # of the scale, per observation: the accuracy of the boat's own position
_ACCEL = 0.25  # of the scale, m/s²: acceleration of moving obstacles
_SMALL = 0.75  # of the scale, radius: the near side of a larger one moves along with the boat
_LEAST_PACE = 0.12  # of the scale, m/s: slower motion is swinging at anchor
_MAX_GROUP = 32


class ObstacleTracks:
    """scale_m: the distance to keep, which defines small and slow."""

    def __init__(self, scale_m: float) -> None:
        self.all: list[Track] = []
        self._scale_m = scale_m
        self._group: list[Beam] = []  # echoes of the obstacle under the sweep
        self._before: Beam | None = None  # the beam before its first one
        self._last: Beam | None = None
        self._has_turned_back = False  # the turn of the sweep ended the group
        self._next_number = 1

    def add(self, beam: Beam, occupancy: Occupancy) -> None:
        """Add a ping, in order of time."""
        group = self._group
        self._has_turned_back = False
        if group and not (_is_echo(beam) and self._is_of_group(beam)):
            self._end_group(beam, occupancy)
        if _is_echo(beam):
            if not self._group:
                self._before = None if self._has_turned_back else self._last
            self._group.append(beam)
        self._last = beam

    def known(self, now_s: float) -> list[Track]:
        """Recent tracks with more than one observation."""
        if not self.all:
            return []
        if any(now_s - track.seen_s > LOST_S for track in self.all):
            self.all = [track for track in self.all if now_s - track.seen_s <= LOST_S]
        return [track for track in self.all if track.observations > 1]

    def movers(self, now_s: float) -> list[Track]:
        """Tracks known to move."""
        return [track for track in self.known(now_s) if track.is_mover] if self.all else []

    def likely(self, now_s: float) -> list[Track]:
        """Movers, and recent probable movers."""
        return [
            track
            for track in self.known(now_s)
            if track.is_mover or (track.is_likely_mover and now_s - track.seen_s < _AGAIN_S)
        ]

    def _is_of_group(self, beam: Beam) -> bool:
        """Whether an echo continues the group: the next beam in the same direction, at a similar range."""
        group = self._group
        last = group[-1]
        if len(group) >= _MAX_GROUP or not _is_beside(last, beam):
            return False
        if len(group) > 1 and _turned_rad(group[-2], last) * _turned_rad(last, beam) < 0.0:
            return False
        return abs(beam.range_m - last.range_m) < _SAME_THING * self._scale_m

    def _is_free(self, edge: Beam, beside: Beam | None) -> bool:
        """Whether the beam beside a group's edge saw free water."""
        if beside is None or not _is_beside(edge, beside):
            return False
        if not _is_echo(beside):
            return True
        turned = _turned_rad(edge, beside)
        a, b = edge.range_m, beside.range_m
        apart_m = math.sqrt(max(a * a + b * b - 2.0 * a * b * math.cos(turned), 0.0))
        return b > a and apart_m > _FREE_BESIDE * self._scale_m

    def _end_group(self, after: Beam, occupancy: Occupancy) -> None:
        """The sweep has passed an obstacle, or has turned back."""
        group, self._group = self._group, []
        first, last = group[0], group[-1]
        self._has_turned_back = (
            len(group) > 1 and _turned_rad(group[-2], last) * _turned_rad(last, after) < 0.0
        )
        before = self._before
        is_whole = not self._has_turned_back and before is not None and _is_beside(before, first)
        is_alone = is_whole and self._is_free(last, after) and self._is_free(first, before)
        turned = abs(_turned_rad(first, last))
        range_m, along_m = min(beam.range_m for beam in group), _RANGE_SIGMA * self._scale_m
        extent_m = range_m * max(turned, 0.5 * first.width_rad)
        if turned * range_m > _LONGEST * self._scale_m:
            return
        nearest = min(group, key=_range_m)
        bearing = first.bearing_rad + 0.5 * _turned_rad(first, last)  # it may span several beams
        ahead_n, ahead_e = math.cos(bearing), math.sin(bearing)
        at = Point(nearest.north_m + range_m * ahead_n, nearest.east_m + range_m * ahead_e)
        across_m = max(_CORRELATED * range_m * first.width_rad / math.sqrt(12.0), along_m)
        track = self._find(at, nearest.time_s, (ahead_n, ahead_e), along_m, across_m)
        radius_m = min(max(0.5 * extent_m, 0.3 * self._scale_m), self._scale_m)
        is_new = track is None
        if track is None:
            track = self._begin(nearest.time_s, at, radius_m)
        track.correct(at, ahead_n, ahead_e, along_m)
        if is_new or is_whole:  # the centre of a partly seen obstacle is unknown
            track.correct(at, -ahead_e, ahead_n, across_m)
        track.is_cut_off = not is_whole
        if is_new:
            track.isolated_count = int(is_alone)
            return
        track.complete_observation(radius_m, ahead_n, ahead_e, is_alone=is_alone)
        is_small = track.radius_m < _SMALL * self._scale_m
        track.classify(occupancy, _LEAST_PACE * self._scale_m, nearest.time_s, is_small=is_small)

    def _find(
        self, at: Point, time_s: float, ahead: tuple[float, float], along_m: float, across_m: float
    ) -> Track | None:
        """The most likely track within the gate, predicted to now, or None."""
        north, east = ahead
        found, least = None, _GATE_SIGMAS
        for track in self.all:
            track.predict(time_s, _ACCEL * self._scale_m)
            size_m = 0.5 * track.radius_m
            surprise = math.hypot(
                track.deviation_sigmas(at, north, east, math.hypot(along_m, size_m)),
                track.deviation_sigmas(at, -east, north, math.hypot(across_m, size_m)),
            )
            if surprise < least:
                found, least = track, surprise
        return found

    def _begin(self, time_s: float, at: Point, radius_m: float) -> Track:
        if len(self.all) >= MAX_TRACKS:
            self.all.remove(min(self.all, key=_last_seen_s))
        track = Track(self._next_number, time_s, at, radius_m)
        self.all.append(track)
        self._next_number += 1
        return track


def _is_echo(beam: Beam) -> bool:
    return beam.range_m <= beam.reach_m


def _range_m(beam: Beam) -> float:
    return beam.range_m


def _turned_rad(first: Beam, then: Beam) -> float:
    return math.remainder(then.bearing_rad - first.bearing_rad, math.tau)


def _is_beside(first: Beam, then: Beam) -> bool:
    """Whether two beams are adjacent in bearing and time."""
    turned = abs(_turned_rad(first, then))
    return (
        0.1 * then.width_rad < turned < 1.5 * then.width_rad
        and abs(then.time_s - first.time_s) < _SAME_PASS_S
    )


def _last_seen_s(track: Track) -> float:
    return track.seen_s
