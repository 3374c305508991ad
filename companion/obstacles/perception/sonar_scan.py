"""What the rangers have seen around the boat lately, by direction: 72 sectors of 5°."""

import math

from companion.sensors.readings import SonarReading

SECTORS = 72
SECTOR_RAD = 2.0 * math.pi / SECTORS
STALE_S = 3.0  # a swept ranger comes round again well within this
_BEAM_RAD = math.radians(15.0)

UNKNOWN_CM = 0xFFFF


class SonarScan:
    """The latest ping of each sector; sector 0 is centred on the bow, and they go clockwise."""

    def __init__(self) -> None:
        self.latest: SonarReading | None = None
        self._pings: list[SonarReading | None] = [None] * SECTORS

    def add(self, ping: SonarReading, beam_rad: float = _BEAM_RAD) -> None:
        """Take a ping; it holds for every sector whose centre lies in its beam, and for the nearest."""
        self.latest = ping
        half = 0.5 * min(beam_rad, 2.0 * math.pi)
        centre = round(ping.bearing_rad / SECTOR_RAD)
        first = min(math.ceil((ping.bearing_rad - half) / SECTOR_RAD), centre)
        last = max(math.floor((ping.bearing_rad + half) / SECTOR_RAD), centre)
        for sector in range(first, min(last, first + SECTORS - 1) + 1):
            self._pings[sector % SECTORS] = ping

    def is_empty(self, now_s: float) -> bool:
        """Whether nothing at all has been heard of late."""
        return self.latest is None or now_s - self.latest.time_s > STALE_S

    def distances_cm(self, now_s: float) -> tuple[list[int], int]:
        """OBSTACLE_DISTANCE's numbers, and the farthest that they reach.

        Farthest + 1 where nothing was met as far as that; UNKNOWN_CM where nobody looked, or not so far.
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
        return min(round(100.0 * ping.range_m), farthest_cm + 1)
    return farthest_cm + 1 if ping.max_range_m >= reach_m else UNKNOWN_CM
