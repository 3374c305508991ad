"""What the rangers have seen around the boat lately, by direction: 72 sectors of 5°."""

import math

from companion.sensors.readings import SonarReading

SECTORS = 72
SECTOR_RAD = 2.0 * math.pi / SECTORS
STALE_S = 3.0  # a swept ranger comes round again well within this
_BEAM_RAD = math.radians(15.0)

UNKNOWN_CM = 0xFFFF


class Sweep:
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

    def max_range_m(self) -> float:
        """How far the latest ping would have reached."""
        return 0.0 if self.latest is None else self.latest.max_range_m

    def distances_cm(self, now_s: float) -> list[int]:
        """OBSTACLE_DISTANCE's numbers: farthest + 1 where nothing was met, UNKNOWN_CM where nobody looked."""
        clear_cm = min(round(100.0 * self.max_range_m()) + 1, UNKNOWN_CM - 1)
        oldest_s = now_s - STALE_S
        return [
            UNKNOWN_CM
            if ping is None or ping.time_s < oldest_s
            else clear_cm
            if ping.range_m is None
            else min(round(100.0 * ping.range_m), clear_cm)
            for ping in self._pings
        ]
