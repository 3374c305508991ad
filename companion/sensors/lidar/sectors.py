"""The rays of a scanning lidar in sectors of 5°: the nearest echo of each pass, free water, or nothing.

An echo counts if the next ray or the pass before met something at a similar range: drops, spray and sun are
single. A sector is free if none of its rays met anything. One that met something too weak to tell, or closer
than the least range, keeps it from being free, and so do lost rays.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from companion.config.sensors import LidarPart
from companion.core.readings import SonarReading
from companion.core.units import wrap_pi

SECTORS: Final = 72
SECTOR_RAD: Final = math.tau / SECTORS
NO_ECHO: Final = math.inf
DOUBTFUL: Final = math.nan

_FEWEST: Final = 3  # rays of a free sector: half of an LD06's 6.3; an RPLIDAR A1 has 5 at 5.5 Hz
_OPEN: Final = 3  # sectors behind the latest ray: an A1 gives rays without an echo up to 8° too early
_SIMILAR_M: Final = 0.3  # a boat of 2 m/s makes as much in a pass of 0.15 s
_GAP_S: Final = 0.5  # without rays: what was begun is too old

Ray = tuple[float, float]
"""Angle from the lidar's zero, in its direction of rotation, and range."""


@dataclass(slots=True, eq=False)
class _Sector:
    """A pass. single_m: of the nearest echo; before_m: that of the pass before; nearest_m: of the nearest one
    that counts.
    """

    bearing_rad: float
    is_blind: bool
    rays: int = 0
    is_doubtful: bool = False
    single_m: float = NO_ECHO
    nearest_m: float = NO_ECHO
    before_m: float = NO_ECHO
    time_s: float = 0.0
    due_s: float = -math.inf


class SectorScan:
    """Sectors are centred on multiples of 5° from the lidar's zero."""

    def __init__(self, part: LidarPart) -> None:
        self._part = part
        self._least_m, self._greatest_m = part.range_m
        self._clear()

    def _clear(self) -> None:
        """Forget all rays."""
        part, turn_rad = self._part, -SECTOR_RAD if self._part.upside_down else SECTOR_RAD
        bearings = [wrap_pi(part.yaw_rad + number * turn_rad) for number in range(SECTORS)]
        self._sectors = [_Sector(one, part.is_blind(one, 0.5 * SECTOR_RAD)) for one in bearings]
        self._last = self._sectors[0], NO_ECHO  # of the latest ray
        self._oldest = 0  # number of the first open sector
        self._latest_s = -math.inf

    def add(self, rays: Sequence[Ray], end_s: float, ray_s: float) -> list[SonarReading]:
        """The readings that these rays complete. end_s: time of the last one; ray_s: between two of them."""
        time_s = end_s - len(rays) * ray_s
        if time_s - self._latest_s > _GAP_S:
            self._clear()
        self._latest_s = end_s
        readings: list[SonarReading] = []
        for angle_rad, range_m in rays:
            time_s += ray_s
            number = int(angle_rad / SECTOR_RAD + 0.5) % SECTORS
            ahead = (number - self._oldest) % SECTORS
            if ahead > SECTORS // 2:
                continue  # its sector is closed
            for _ in range(ahead - _OPEN):
                readings += self._close(self._sectors[self._oldest])
                self._oldest = (self._oldest + 1) % SECTORS
            self._add(self._sectors[number], range_m, time_s)
        return readings

    def _add(self, sector: _Sector, range_m: float, time_s: float) -> None:
        (last, last_m), self._last = self._last, (sector, NO_ECHO)
        sector.rays += 1
        sector.time_s = time_s
        if range_m > self._greatest_m:
            return
        if not range_m >= self._least_m:
            sector.is_doubtful = True
            return
        self._last = sector, range_m
        sector.single_m = min(sector.single_m, range_m)
        if abs(range_m - last_m) < _SIMILAR_M:
            sector.nearest_m = min(sector.nearest_m, range_m)
            last.nearest_m = min(last.nearest_m, last_m)

    def _close(self, one: _Sector) -> list[SonarReading]:
        """End its pass; the reading, if it has one."""
        is_free = one.single_m == NO_ECHO and one.rays >= _FEWEST and not one.is_doubtful
        range_m = one.single_m if abs(one.single_m - one.before_m) < _SIMILAR_M else one.nearest_m
        one.before_m, one.single_m, one.nearest_m = one.single_m, NO_ECHO, NO_ECHO
        one.rays, one.is_doubtful = 0, False
        if one.is_blind or one.time_s < one.due_s or (range_m == NO_ECHO and not is_free):
            return []
        one.due_s, echo_m = one.time_s + self._part.period_s, None if range_m == NO_ECHO else range_m
        return [SonarReading(one.time_s, one.bearing_rad, echo_m, self._least_m, self._greatest_m)]
