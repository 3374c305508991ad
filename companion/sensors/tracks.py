"""Things told apart: small groups of echoes, followed from sweep to sweep.

Echoes of neighbouring beams at about one range are one thing. A long one is shore, and is left to the map
(`occupancy.py`); a small one is looked for among the tracks by its distance in standard deviations, along the
beam and across it.
"""

import math

from companion.geo import Point
from companion.sensors.occupancy import Beam, Occupancy
from companion.sensors.track import Track

MAX_TRACKS = 16
LOST_S = 4.0  # not seen for so long: forgotten. A sweep goes to and fro in 1.4 s
_GATE_SIGMAS = 3.0
_CORRELATED = 1.5  # where in the beam the echo comes from is no fresh chance at each look
_SAME_PASS_S = 0.4  # echoes of neighbouring beams come within this
_SAME_THING = 0.6  # of the scale: nearer in range to its neighbour is the same thing
_LONGEST = 2.0  # of the scale: what is longer is shore
_RANGE_SIGMA = 0.06  # of the scale, per look: the boat's own position is no better known
_ACCEL = 0.25  # of the scale, m/s²: what moves about on a water changes its ways slowly
_LEAST_PACE = 0.12  # of the scale, m/s: slower is a thing that swings at its anchor
_MAX_GROUP = 32


class Tracks:
    """What is followed. scale_m: the distance that the boat keeps, which says what is small and what is
    slow.
    """

    __slots__ = ("_group", "_next_number", "_scale_m", "all")

    def __init__(self, scale_m: float) -> None:
        self.all: list[Track] = []
        self._scale_m = scale_m
        self._group: list[Beam] = []  # echoes of the thing that the sweep is passing over
        self._next_number = 1

    def add(self, beam: Beam, occupancy: Occupancy) -> None:
        """Take a look, in the order of time."""
        is_echo = beam.range_m <= beam.reach_m
        group = self._group
        if group and not (is_echo and self._is_neighbour(group[-1], beam) and len(group) < _MAX_GROUP):
            self._end_group(occupancy)
        if is_echo:
            self._group.append(beam)

    def known(self, now_s: float) -> list[Track]:
        """What was seen of late, and more than once."""
        if not self.all:
            return []
        if any(now_s - track.seen_s > LOST_S for track in self.all):
            self.all = [track for track in self.all if now_s - track.seen_s <= LOST_S]
        return [track for track in self.all if track.looks > 1]

    def movers(self, now_s: float) -> list[Track]:
        """What is known to move."""
        return [track for track in self.known(now_s) if track.is_mover] if self.all else []

    def _is_neighbour(self, last: Beam, beam: Beam) -> bool:
        """Whether two echoes are of one thing: beams side by side, ranges alike."""
        turned = abs(math.remainder(beam.bearing_rad - last.bearing_rad, math.tau))
        return (
            0.1 * beam.width_rad < turned < 1.5 * beam.width_rad
            and beam.time_s - last.time_s < _SAME_PASS_S
            and abs(beam.range_m - last.range_m) < _SAME_THING * self._scale_m
        )

    def _end_group(self, occupancy: Occupancy) -> None:
        """The sweep has passed over a thing."""
        group, self._group = self._group, []
        first, last = group[0], group[-1]
        turned = abs(math.remainder(last.bearing_rad - first.bearing_rad, math.tau))
        range_m, along_m = min(beam.range_m for beam in group), _RANGE_SIGMA * self._scale_m
        extent_m = range_m * (turned + 0.5 * first.width_rad)
        if turned * range_m > _LONGEST * self._scale_m:
            return
        nearest = [beam for beam in group if beam.range_m < range_m + along_m]
        middle = nearest[len(nearest) // 2]
        ahead_n, ahead_e = math.cos(middle.bearing_rad), math.sin(middle.bearing_rad)
        at = Point(middle.north_m + range_m * ahead_n, middle.east_m + range_m * ahead_e)
        across_m = max(_CORRELATED * range_m * first.width_rad / math.sqrt(12.0), along_m)
        track = self._find(at, middle.time_s, (ahead_n, ahead_e), along_m, across_m)
        radius_m = min(max(0.5 * extent_m, 0.3 * self._scale_m), self._scale_m)
        is_new = track is None
        if track is None:
            track = self._begin(middle.time_s, at, radius_m)
        track.correct(at, ahead_n, ahead_e, along_m)
        track.correct(at, -ahead_e, ahead_n, across_m)
        if is_new:
            return
        track.keep(radius_m, ahead_n, ahead_e)
        track.judge(occupancy, _LEAST_PACE * self._scale_m, middle.time_s)

    def _find(
        self, at: Point, time_s: float, ahead: tuple[float, float], along_m: float, across_m: float
    ) -> Track | None:
        """The track that this is most likely of, carried on to now; None if there is none within the gate."""
        north, east = ahead
        found, least = None, _GATE_SIGMAS
        for track in self.all:
            track.predict(time_s, _ACCEL * self._scale_m)
            size_m = 0.5 * track.radius_m
            surprise = math.hypot(
                track.surprise(at, north, east, math.hypot(along_m, size_m)),
                track.surprise(at, -east, north, math.hypot(across_m, size_m)),
            )
            if surprise < least:
                found, least = track, surprise
        return found

    def _begin(self, time_s: float, at: Point, radius_m: float) -> Track:
        if len(self.all) >= MAX_TRACKS:
            self.all.remove(min(self.all, key=_last_look_s))
        track = Track(self._next_number, time_s, at, radius_m)
        self.all.append(track)
        self._next_number += 1
        return track


def _last_look_s(track: Track) -> float:
    return track.seen_s
