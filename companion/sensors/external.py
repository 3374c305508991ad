"""Readings that come over MAVLink instead of from a part: they stand in for receiver, compass and sonar.

A camera over a pool, a better receiver on another computer, a simulator. The latest of each is held here,
stamped with the boat's clock, until it is stale.
"""

from collections import deque
from enum import IntEnum

from companion.config.boat_config import External
from companion.core.geo import LatLon, LocalFrame
from companion.sensors.readings import GnssFix, HeadingReading, SonarReading

MIN_FIX_TYPE = 3
_MAX_PINGS = 144  # two rounds of an OBSTACLE_DISTANCE


class Use(IntEnum):
    """When a reading from outside is taken."""

    NEVER = 0
    FALLBACK = 1  # while the boat's own part is silent
    PREFERRED = 2  # before the boat's own part, as long as it comes


class ExternalSensors:
    """Filled by the service that hears them, read once a tick."""

    def __init__(self, setting: External) -> None:
        self.fix: GnssFix | None = None
        self.heading: HeadingReading | None = None
        self.frame: LocalFrame | None = None  # in which local poses are meant; None: they have no place yet
        self.pings: deque[tuple[SonarReading, float]] = deque(maxlen=_MAX_PINGS)  # and their beams in rad
        if setting.origin_lat_deg or setting.origin_lon_deg:
            self.frame = LocalFrame(LatLon(setting.origin_lat_deg, setting.origin_lon_deg))

    def choose_fix(self, own: GnssFix | None, setting: External, now_s: float) -> GnssFix | None:
        """The fix to steer by."""
        if not setting.position:  # Use.NEVER, as mostly
            return own
        usable = own if own is not None and own.fix_type >= MIN_FIX_TYPE else None
        if _takes_external(usable, self.fix, setting.position, setting.timeout_s, now_s):
            return self.fix
        return own

    def choose_heading(
        self, own: HeadingReading | None, setting: External, now_s: float
    ) -> HeadingReading | None:
        """The heading to steer by."""
        if not setting.heading:
            return own
        if _takes_external(own, self.heading, setting.heading, setting.timeout_s, now_s):
            return self.heading
        return own


def _takes_external(
    own: GnssFix | HeadingReading | None,
    external: GnssFix | HeadingReading | None,
    use: int,
    timeout_s: float,
    now_s: float,
) -> bool:
    if external is None or now_s - external.time_s > timeout_s:
        return False
    return use == Use.PREFERRED or own is None or now_s - own.time_s > timeout_s
