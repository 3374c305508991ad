"""Groups echoes into obstacles and tracks them from sweep to sweep.

Echoes of neighbouring beams at similar ranges form one group. A long group is shore and stays in the grid
only (`occupancy.py`). A short one is associated with a track by its deviation along and across the beam. A
group with free water on either side is isolated; otherwise it may be the end of a longer obstacle, and the
visible end of a shore moves along with the boat. Lengths are in scales: the distance that the boat keeps.
"""

import math
from typing import Final

from companion.core.geo import Point
from companion.obstacles.perception.occupancy import CORE, SILENCE, SOLID, SUSPECT, SWEEP_S, Beam
from companion.obstacles.perception.track import Track

MAX_TRACKS: Final = 16
SAME_PASS_S: Final = 0.4  # between neighbouring beams
_GATE_SIGMAS: Final = 3.0
FREE_BESIDE: Final = 1.5  # scales: a neighbouring echo farther off belongs to something else
_SAME_THING: Final = 0.6  # scales: largest difference in range within a group
LONGEST: Final = 2.0  # scales: a longer group is shore
_RANGE_SIGMA: Final = 0.05  # scales, per observation: the accuracy of the boat's own position
_ACCEL: Final = 0.25  # scales, m/s²: a swimmer's, and a boat's that turns away
_LEAST_PACE: Final = 0.12  # scales, m/s: slower motion is swinging at anchor
# Of the beam width: an echo comes from anywhere within it, alike in one ping after another, so that
# averaging does not help: 1.5 times the deviation of an even distribution.
_ACROSS: Final = 2.0 / math.sqrt(12.0)


class ObstacleTracks:
    """scale_m: the distance to keep, which defines small and slow."""

    def __init__(self, scale_m: float) -> None:
        self.all: list[Track] = []
        self._scale_m = scale_m
        self._group: list[Beam] = []  # echoes of the obstacle under the sweep
        self._before: Beam | None = None  # the beam before its first one
        self._last: Beam | None = None
        self._next_number = 1

    def add(self, beam: Beam) -> None:
        """Add a ping, in order of time."""
        has_turned_back = False
        if self._group and not (beam.is_echo and self._is_of_group(beam)):
            has_turned_back = _turns_back(self._group, beam)
            self._end_group(None if has_turned_back else beam)
        if beam.is_echo:
            if not self._group:
                self._before = None if has_turned_back else self._last
            self._group.append(beam)
        elif self.all:
            self._refute(beam)
        self._last = beam

    def known(self, now_s: float) -> list[Track]:
        """Recent tracks with more than one observation."""
        if self.all:
            self._forget(now_s)
        return [track for track in self.all if track.observations > 1]

    def movers(self, now_s: float) -> list[Track]:
        """Tracks known to move."""
        return [track for track in self.known(now_s) if track.is_mover]

    def possible_movers(self, now_s: float, *, in_open_water: bool) -> list[Track]:
        """Movers, and what may turn out to be one; in open water with the evidence of a solid cell."""
        self._forget(now_s)
        least = SOLID if in_open_water else SUSPECT
        return [track for track in self.all if track.evidence >= least and track.may_move(now_s)]

    def _forget(self, now_s: float) -> None:
        """Remove lost tracks; one that a full sweep has not observed again was a ghost, which the next thing
        seen must not be taken for.
        """
        self.all = [
            track
            for track in self.all
            if now_s - track.seen_s <= (3.0 if track.observations > 1 else 1.0) * SWEEP_S
        ]

    def _refute(self, beam: Beam) -> None:
        """Take the evidence of tracks where a beam met nothing, and remove those without any left."""
        for track in self.all:
            if _looks_through(beam, track.point(beam.time_s)):
                track.evidence -= SILENCE
        self.all = [track for track in self.all if track.evidence > 0.0]

    def _is_of_group(self, beam: Beam) -> bool:
        """Whether an echo continues the group: the next beam in the same direction, at a similar range."""
        last = self._group[-1]
        is_next = _is_beside(last, beam) and not _turns_back(self._group, beam)
        return is_next and abs(beam.range_m - last.range_m) < _SAME_THING * self._scale_m

    def _is_free(self, edge: Beam, beside: Beam | None) -> bool:
        """Whether the beam beside a group's edge saw free water."""
        if beside is None or not _is_beside(edge, beside):
            return False
        if not beside.is_echo:
            return True
        a, b = edge.range_m, beside.range_m
        apart_m = math.sqrt(max(a * a + b * b - 2.0 * a * b * math.cos(_turned_rad(edge, beside)), 0.0))
        return b > a and apart_m > FREE_BESIDE * self._scale_m

    def _end_group(self, after: Beam | None) -> None:
        """The sweep has passed an obstacle; after: the beam beyond it, None if the sweep has turned back."""
        group, self._group, before, scale_m = self._group, [], self._before, self._scale_m
        first, last = group[0], group[-1]
        turned = _turned_rad(first, last)
        nearest = min(group, key=lambda beam: beam.range_m)
        range_m, along_m = nearest.range_m, _RANGE_SIGMA * scale_m
        if abs(turned) * range_m > LONGEST * scale_m:
            return
        is_whole = after is not None and before is not None and _is_beside(before, first)
        is_alone = is_whole and self._is_free(last, after) and self._is_free(first, before)
        bearing = first.bearing_rad + 0.5 * turned  # it may span several beams
        north, east = math.cos(bearing), math.sin(bearing)
        at = nearest.at.moved(bearing, range_m)
        across_m = max(_ACROSS * range_m * first.width_rad, along_m)
        radius_m = 0.5 * range_m * max(abs(turned), 0.5 * first.width_rad)
        radius_m = min(max(radius_m, 0.3 * scale_m), scale_m)
        track = self._find(at, nearest.time_s, north, east, along_m, across_m)
        is_new = track is None
        if track is None:
            track = self._begin(nearest.time_s, at, radius_m)
        track.correct(at, north, east, along_m)
        if is_new or is_whole:  # the centre of a partly seen obstacle is unknown
            track.correct(at, -east, north, across_m)
        track.whole_count += is_whole
        if is_new:
            track.isolated_count = int(is_alone)
            return
        track.complete_observation(radius_m, north, east, is_alone=is_alone)
        track.classify(_LEAST_PACE * scale_m)

    def _find(
        self, at: Point, time_s: float, north: float, east: float, along_m: float, across_m: float
    ) -> Track | None:
        """The most likely track within the gate, predicted to now, or None."""
        self._forget(time_s)
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
            self.all.remove(min(self.all, key=lambda track: track.seen_s))
        track = Track(self._next_number, time_s, at, radius_m)
        self.all.append(track)
        self._next_number += 1
        return track


def _turned_rad(first: Beam, then: Beam) -> float:
    return math.remainder(then.bearing_rad - first.bearing_rad, math.tau)


def _turns_back(group: list[Beam], beam: Beam) -> bool:
    """Whether the sweep reverses after the last of two or more beams."""
    if len(group) < 2:
        return False
    return _turned_rad(group[-2], group[-1]) * _turned_rad(group[-1], beam) < 0.0


def _is_beside(first: Beam, then: Beam) -> bool:
    """Whether two beams are adjacent in bearing and time."""
    turned, width_rad = abs(_turned_rad(first, then)), then.width_rad
    return 0.1 * width_rad < turned < 1.5 * width_rad and abs(then.time_s - first.time_s) < SAME_PASS_S


def _looks_through(beam: Beam, at: Point) -> bool:
    """Whether a place is in the core of a beam."""
    north, east = at.north_m - beam.at.north_m, at.east_m - beam.at.east_m
    off_rad = math.remainder(math.atan2(east, north) - beam.bearing_rad, math.tau)
    is_in_reach = beam.blind_m <= math.hypot(north, east) < beam.reach_m
    return is_in_reach and abs(off_rad) < 0.5 * CORE * beam.width_rad
