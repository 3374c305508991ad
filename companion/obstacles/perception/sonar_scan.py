"""Latest ranges around the boat by direction: 72 sectors of 5°."""

import math

from companion.core.readings import SonarReading

SECTORS = 72
SECTOR_RAD = 2.0 * math.pi / SECTORS
STALE_S = 3.0  # more than the period of a sweep
_BEAM_RAD = math.radians(15.0)

UNKNOWN_CM = 0xFFFF


class SonarScan:
    """The latest ping of each sector; sector 0 is centred on the bow, numbers increase clockwise."""

    def __init__(self) -> None:
        self.latest: SonarReading | None = None
        self._pings: list[SonarReading | None] = [None] * SECTORS

    def add(self, ping: SonarReading, beam_rad: float = _BEAM_RAD) -> None:
        """Add a ping to every sector whose centre lies in its beam, and to the nearest."""
        self.latest = ping
        half = 0.5 * min(beam_rad, 2.0 * math.pi)
        centre = round(ping.bearing_rad / SECTOR_RAD)
        first = min(math.ceil((ping.bearing_rad - half) / SECTOR_RAD), centre)
        last = max(math.floor((ping.bearing_rad + half) / SECTOR_RAD), centre)
        for sector in range(first, min(last, first + SECTORS - 1) + 1):
            self._pings[sector % SECTORS] = ping

    def is_empty(self, now_s: float) -> bool:
        """Whether there is no recent ping."""
        return self.latest is None or now_s - self.latest.time_s > STALE_S

    def distances_cm(self, now_s: float) -> tuple[list[int], int]:
        """Distances for OBSTACLE_DISTANCE, and the maximum distance.

        Maximum + 1: no obstacle within it; UNKNOWN_CM: not measured, or not that far. An echo closer than the
        ranger can see is at its least range: stations ignore what is below that.
        """
        oldest_s = now_s - STALE_S
        fresh = [ping if ping is not None and ping.time_s >= oldest_s else None for ping in self._pings]
        reach_m = max((ping.max_range_m for ping in fresh if ping is not None), default=0.0)
        farthest_cm = min(round(100.0 * reach_m), UNKNOWN_CM - 2)
        return [_distance_cm(ping, reach_m, farthest_cm) for ping in fresh], farthest_cm


def _distance_cm(ping: SonarReading | None, reach_m: float, farthest_cm: int) -> int:
    if ping is None:
        return UNKNOWN_CM
    if ping.range_m is not None:
        return min(round(100.0 * max(ping.range_m, ping.min_range_m)), farthest_cm + 1)
    return farthest_cm + 1 if ping.max_range_m >= reach_m else UNKNOWN_CM
