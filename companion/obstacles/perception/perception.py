"""Obstacle perception: turns pings of all rangers and the boat's pose into a grid, tracks and known water.

Invalid pings (not a number, no direction, wrong time) are dropped and counted. While the boat's own ranger is
noisy, its pings are dropped, and the grid and tracks are cleared.
"""

import math
from collections.abc import Sequence
from typing import Final

from companion.config.tuning import AvoidanceSetting
from companion.core.geo import Point
from companion.core.readings import SonarReading
from companion.core.state import NavState
from companion.obstacles.perception.looked_at import LookedAtWater
from companion.obstacles.perception.occupancy import Beam, Occupancy
from companion.obstacles.perception.sonar_noise import SonarNoiseMonitor
from companion.obstacles.perception.sonar_schedule import ALL_ROUND, Sector, choose_sector
from companion.obstacles.perception.track import Track
from companion.obstacles.perception.tracks import FREE_BESIDE, LONGEST, ObstacleTracks
from companion.obstacles.perception.vessels import Vessel
from companion.obstacles.perception.voyage_map import VoyageMap

_CELLS_A_MARGIN: Final = 5.0  # the resolution follows the distance to keep
_STALE_S: Final = 1.0  # a full sweep: an older ping was before the present one
_STALE_POSE_S: Final = 2.0  # at cruise an echo would be located 4 m off, the whole sight
_LOOK_AGAIN_S: Final = 0.3  # five pings, in which a servo turns back to an echo
_REMEMBERED_REACHES: Final = 3.0  # a detour of several sights comes back to what began it


class ObstaclePerception:
    """occupancy: static obstacles around the boat. voyage: those of the whole voyage. tracks: moving ones.
    water: known to be free. dropped: unusable pings.
    reach_m: range of the farthest ranger that was heard lately. sector: where to point the boat's own ranger.
    wished_course_rad: about to be taken, set by the planner. vessels: with AIS, set by the boat.
    """

    def __init__(self, setting: AvoidanceSetting, voyage: VoyageMap | None = None) -> None:
        self.voyage = voyage or VoyageMap()
        self.water = LookedAtWater()
        self.dropped = 0
        self.reach_m, self.heard_s, self._reach_s = 0.0, -math.inf, -math.inf
        self.sector: Sector = ALL_ROUND
        self.wished_course_rad: float | None = None
        self.vessels: Sequence[Vessel] = ()
        self._noise = SonarNoiseMonitor()
        self._single: Beam | None = None  # the latest echo of the boat's own ranger
        self._tidy_s = 0.0
        self._setting = setting
        self.occupancy, self.tracks = _empty_map(setting)

    @property
    def is_noisy(self) -> bool:
        """Whether the boat's own ranger is noisy."""
        return self._noise.is_noisy

    @property
    def is_empty(self) -> bool:
        """Whether nothing is known. Moving obstacles leave echoes in the grid, too."""
        return len(self.occupancy) == 0

    def clear(self) -> None:
        """Forget all: the local frame has moved."""
        self.occupancy.clear()
        self.water.clear()
        self.voyage.clear()

    def is_near(self, at: Point) -> bool:
        """Whether anything is known within sight of a place."""
        return not self.is_empty and self.occupancy.is_near(at, self.reach_m + self._setting.margin_m)

    def ingest(
        self,
        pings: Sequence[tuple[SonarReading, float | None]],
        nav: NavState | None,
        setting: AvoidanceSetting,
        now_s: float,
    ) -> None:
        """Process the tick's pings, each with its beam width in rad; None: the boat's own ranger."""
        if setting is not self._setting:
            before, self._setting = self._setting, setting
            if setting.margin_m != before.margin_m:
                self.occupancy, self.tracks = _empty_map(setting)
        is_lost = nav is None or max(nav.position_age_s, nav.heading_age_s) > _STALE_POSE_S
        self.water.has_ranger = self.water.has_ranger or bool(pings)
        self.water.distrusts_chart = self.voyage.has_barred_a_way
        for ping, width_rad in pings:
            is_own = width_rad is None
            beam = None
            if not (is_own and self._is_noise(ping)) and nav is not None and not is_lost:
                beam = _beam(ping, width_rad or setting.beam_rad, nav, setting, now_s)
            if beam is None:
                self.dropped += 1
            else:
                self._add(beam, is_own=is_own)
        if nav is None:
            return
        if pings and setting.avoids_obstacles:
            is_open = not self.occupancy.has_solid
            self.sector = choose_sector(
                nav,
                self.tracks,
                self.reach_m,
                now_s,
                self._unconfirmed(now_s) if is_open else None,
                self.wished_course_rad,
                is_open=is_open,
            )
        if now_s >= self._tidy_s:
            self._tidy_s = now_s + _STALE_S
            reach_m = _REMEMBERED_REACHES * setting.lookahead_m
            movers = [track.point(now_s) for track in self.tracks.movers(now_s)]
            self.voyage.update(self.occupancy, setting.margin_m, movers, nav.point, reach_m, now_s)
            self.occupancy.forget(nav.point, reach_m, now_s)

    def solid(self) -> list[Point]:
        """Centres of the solid cells, echoes of moving obstacles included."""
        return self.occupancy.obstacles()

    def suspects(self) -> list[Point]:
        """As `solid`, with cells seen only once, but not for a lone echo in open water."""
        return self.occupancy.likely(FREE_BESIDE * self._setting.margin_m)

    def possible_movers(self, now_s: float) -> tuple[list[Track], int]:
        """Tracks that may move, and the number of still things of the size of a margin around.

        What the grid has known for two sweeps stands still, however its nearest point slides along it as the
        boat passes: a static and a dynamic map (D. Wolf, G. Sukhatme, Autonomous Robots 19, 2005).
        """
        tracks = self.tracks.possible_movers(now_s, in_open_water=not self.occupancy.has_solid)
        standing, side_m = self.occupancy.standing(now_s) if tracks else [], self._setting.margin_m
        for track in tracks:
            track.note_standing(track.point(now_s), standing)
        still = {(at.north_m // side_m, at.east_m // side_m) for at in standing}
        return [track for track in tracks if not track.stands(now_s, LONGEST * side_m)], len(still)

    def _unconfirmed(self, now_s: float) -> Beam | None:
        """The latest echo, until a second look confirms or refutes it."""
        beam = self._single
        is_old = beam is None or now_s - beam.time_s > _LOOK_AGAIN_S
        if beam is not None and (is_old or not self.occupancy.has_suspect_of(beam)):
            self._single = None
        return self._single

    def _add(self, beam: Beam, *, is_own: bool) -> None:
        self.heard_s = beam.time_s
        if beam.reach_m >= self.reach_m or beam.time_s - self._reach_s > _STALE_S:
            self.reach_m, self._reach_s = beam.reach_m, beam.time_s
        if not self.occupancy.add(beam):
            return
        self.tracks.add(beam)
        if movers := self.tracks.movers(beam.time_s):
            self._clear_ways(movers, beam.time_s)
        if self.water.is_used:
            self.water.add(beam)
        if is_own and beam.is_echo:
            self._single = beam

    def _clear_ways(self, movers: Sequence[Track], now_s: float) -> None:
        """Take the echoes of movers out of the grid, unless anything stands: its end may seem to move."""
        if self.occupancy.standing(now_s):
            return
        for track in movers:
            within_m = track.radius_m + 2.0 * self.occupancy.cell_m
            self.occupancy.clear_way(*track.take_way(now_s), within_m, now_s)

    def _is_noise(self, ping: SonarReading) -> bool:
        was_noisy = self._noise.is_noisy
        self._noise.update(ping.range_m, ping.max_range_m)
        if self._noise.is_noisy and not was_noisy:
            self.occupancy, self.tracks = _empty_map(self._setting)
        return self._noise.is_noisy


def _empty_map(setting: AvoidanceSetting) -> tuple[Occupancy, ObstacleTracks]:
    return Occupancy(setting.margin_m / _CELLS_A_MARGIN), ObstacleTracks(setting.margin_m)


def _beam(
    ping: SonarReading, width_rad: float, nav: NavState, setting: AvoidanceSetting, now_s: float
) -> Beam | None:
    """The ping in the local frame, from the pose at its time; None if invalid."""
    age_s = now_s - ping.time_s
    reach_m = min(ping.max_range_m, setting.lookahead_m)
    range_m = math.inf if ping.range_m is None else ping.range_m
    is_sane = -0.1 <= age_s <= _STALE_S and abs(ping.bearing_rad) <= math.tau
    if not (is_sane and reach_m > 0.0 and 0.0 < width_rad <= math.tau and range_m > 0.0):
        return None
    at = Point(nav.north_m - nav.north_m_s * age_s, nav.east_m - nav.east_m_s * age_s)
    bearing_rad = nav.heading_rad - nav.yaw_rate_rad_s * age_s + ping.bearing_rad
    blind_m = ping.min_range_m
    return Beam(ping.time_s, at, bearing_rad, width_rad, max(range_m, blind_m), reach_m, blind_m)
