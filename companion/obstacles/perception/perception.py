"""Obstacle perception: turns sonar pings and the boat's pose into an occupancy grid and tracks.

Invalid pings (not a number, no direction, wrong time) are dropped and counted. While the boat's own ranger is
noisy, its pings are dropped, and the grid and tracks are cleared.
"""

import math
from collections.abc import Sequence

from companion.config.avoidance import AvoidanceSetting
from companion.core.geo import Point
from companion.core.state import NavState
from companion.obstacles.perception.looked_at import LookedAtWater
from companion.obstacles.perception.occupancy import SUSPECT, Beam, Occupancy
from companion.obstacles.perception.sonar_noise import SonarNoiseMonitor
from companion.obstacles.perception.sonar_schedule import ALL_ROUND, Sector, choose_sector, is_unclassified
from companion.obstacles.perception.track import Track
from companion.obstacles.perception.tracks import ObstacleTracks
from companion.sensors.readings import SonarReading

CELLS_A_MARGIN = 5.0  # the resolution follows the distance to keep
MAX_AGE_S = 1.0  # older pings are dropped
STALE_POSE_S = 2.0  # with an older pose an echo cannot be located
_TIDY_S = 1.0
_REMEMBERED_REACHES = 3.0
LOOK_AGAIN_S = 0.3  # to turn a servo back to an echo: five pings of 0.06 s
_MAX_TURNS_RAD = 20.0


class ObstaclePerception:
    """occupancy: static obstacles. tracks: moving ones. water: known to be free. dropped: unusable pings.
    sector: where to point the boat's own ranger.
    """

    def __init__(self, setting: AvoidanceSetting) -> None:
        self.occupancy = Occupancy(setting.margin_m / CELLS_A_MARGIN, setting.memory_s)
        self.tracks = ObstacleTracks(setting.margin_m)
        self.water = LookedAtWater()
        self.dropped = 0
        self._noise = SonarNoiseMonitor()
        self.reach_m = 0.0  # of the farthest ranger that was heard lately
        self._reach_s = -math.inf
        self.heard_s = -math.inf
        self.wished_course_rad: float | None = None  # about to be taken, set by the planner
        self.sector: Sector = ALL_ROUND
        self._silence: SonarReading | None = None  # the last ping, if its processing was deferred
        self._single: Beam | None = None  # the latest echo of the boat's own ranger
        self._setting = setting
        self._tidy_s = 0.0

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
            self._change(setting)
        is_lost = nav is None or max(nav.position_age_s, nav.heading_age_s) > STALE_POSE_S
        self.water.has_ranger = self.water.has_ranger or bool(pings)
        for ping, width_rad in pings:
            if width_rad is None and self._is_noise(ping):
                self.dropped += 1
                continue
            is_quiet = self.is_empty and not self.water.is_used
            if ping.range_m is None and is_quiet and 0.0 <= now_s - ping.time_s <= MAX_AGE_S:
                reach_m = min(
                    ping.max_range_m, setting.lookahead_m
                )  # no echo over open water: the usual case
                if reach_m > 0.0 and not is_lost:
                    self._note_reach(reach_m, ping.time_s)
                    self._silence = ping if width_rad is None else None
                    continue
            beam = None
            if nav is not None and not is_lost:
                if self._silence is not None:
                    self._add(_beam(self._silence, setting.beam_rad, nav, setting, now_s))
                    self._silence = None
                beam = _beam(ping, width_rad or setting.beam_rad, nav, setting, now_s)
            if beam is None:
                self.dropped += 1
                continue
            self._note_reach(beam.reach_m, beam.time_s)
            self._add(beam)
            if width_rad is None and beam.is_echo:
                self._single = beam
        if nav is not None and setting.avoids_obstacles:
            is_open = self.is_empty or not self.occupancy.obstacles(now_s)
            unconfirmed = self._unconfirmed(now_s) if is_open else None
            self.sector = choose_sector(
                nav,
                self.tracks,
                self.reach_m,
                now_s,
                unconfirmed,
                self.wished_course_rad,
                is_open=is_open,
            )
        if nav is not None and now_s >= self._tidy_s and not self.is_empty:
            self._tidy_s = now_s + _TIDY_S
            self.occupancy.forget(nav.point, _REMEMBERED_REACHES * setting.lookahead_m, now_s)

    def solid(self, now_s: float) -> list[Point]:
        """Centres of the solid cells, echoes of moving obstacles included."""
        return self.occupancy.obstacles(now_s)

    def suspects(self, now_s: float) -> list[Point]:
        """As `solid`, with cells seen only once."""
        return self.occupancy.obstacles(now_s, SUSPECT)

    def movers(self, now_s: float) -> list[Track]:
        """Tracks known to move."""
        return self.tracks.movers(now_s)

    def has_unclassified(self, now_s: float) -> bool:
        """Whether some track may turn out to move."""
        return any(is_unclassified(track, now_s) for track in self.tracks.all)

    def _unconfirmed(self, now_s: float) -> Beam | None:
        """The latest echo, until a second look confirms or refutes it."""
        beam = self._single
        if beam is None:
            return None
        if now_s - beam.time_s > LOOK_AGAIN_S or not self.occupancy.has_suspect_of(beam):
            self._single = None
        return self._single

    def _note_reach(self, reach_m: float, time_s: float) -> None:
        self.heard_s = time_s
        if reach_m >= self.reach_m or time_s - self._reach_s > MAX_AGE_S:
            self.reach_m, self._reach_s = reach_m, time_s

    def _add(self, beam: Beam | None) -> None:
        if beam is not None:
            self.occupancy.add(beam)
            self.tracks.add(beam, self.occupancy)
            if self.water.is_used:
                self.water.add(beam)

    def _is_noise(self, ping: SonarReading) -> bool:
        was_noisy = self._noise.is_noisy
        self._noise.update(ping.range_m, ping.max_range_m)
        if self._noise.is_noisy and not was_noisy:
            self._forget()
        return self._noise.is_noisy

    def _change(self, setting: AvoidanceSetting) -> None:
        is_other = (setting.margin_m, setting.memory_s) != (self._setting.margin_m, self._setting.memory_s)
        self._setting = setting
        if is_other:
            self._forget()

    def _forget(self) -> None:
        setting = self._setting
        self.occupancy = Occupancy(setting.margin_m / CELLS_A_MARGIN, setting.memory_s)
        self.tracks = ObstacleTracks(setting.margin_m)


def _beam(
    ping: SonarReading, width_rad: float, nav: NavState, setting: AvoidanceSetting, now_s: float
) -> Beam | None:
    """The ping in the local frame, from the pose at its time; None if invalid."""
    age_s = now_s - ping.time_s
    reach_m = min(ping.max_range_m, setting.lookahead_m)
    is_sane = -0.1 <= age_s <= MAX_AGE_S and abs(ping.bearing_rad) <= _MAX_TURNS_RAD
    if not is_sane or not reach_m > 0.0 or not 0.0 < width_rad <= math.tau:
        return None
    range_m = math.inf if ping.range_m is None else ping.range_m
    if not range_m > 0.0:
        return None
    at = Point(nav.north_m - nav.north_m_s * age_s, nav.east_m - nav.east_m_s * age_s)
    heading_rad = nav.heading_rad - nav.yaw_rate_rad_s * age_s
    blind_m = ping.min_range_m
    return Beam(
        ping.time_s, at, heading_rad + ping.bearing_rad, width_rad, max(range_m, blind_m), reach_m, blind_m
    )
