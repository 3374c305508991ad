"""Sensor readings over MAVLink, in place of receiver, compass and sonar.

Sources: a camera over a pool, a receiver on another computer, a simulator. The latest reading of each is
kept, stamped with the boat's clock, until it is stale.
"""

from collections import deque
from enum import IntEnum

from companion.config.boat_config import External
from companion.core.geo import LatLon, LocalFrame
from companion.core.readings import GnssFix, HeadingReading, SonarReading

MIN_FIX_TYPE = 3
_MAX_PINGS = 144  # two rounds of an OBSTACLE_DISTANCE


class Use(IntEnum):
    """When an external reading is used."""

    NEVER = 0
    FALLBACK = 1  # while the boat's own sensor is silent
    PREFERRED = 2  # instead of the boat's own sensor


class ExternalSensors:
    """Filled by the external pose service, read once a tick."""

    def __init__(self, setting: External) -> None:
        self.fix: GnssFix | None = None
        self.heading: HeadingReading | None = None
        self.frame: LocalFrame | None = None  # frame of local poses; None: unknown
        # with their beam widths in rad
        self.pings: deque[tuple[SonarReading, float]] = deque(maxlen=_MAX_PINGS)
        if setting.origin_lat_deg or setting.origin_lon_deg:
            self.frame = LocalFrame(LatLon(setting.origin_lat_deg, setting.origin_lon_deg))

    def choose_fix(self, own: GnssFix | None, setting: External, now_s: float) -> GnssFix | None:
        """The fix to use."""
        if not setting.position:  # Use.NEVER, the usual case
            return own
        usable = own if own is not None and own.fix_type >= MIN_FIX_TYPE else None
        if _takes_external(usable, self.fix, setting.position, setting.timeout_s, now_s):
            return self.fix
        return own

    def choose_heading(
        self, own: HeadingReading | None, setting: External, now_s: float
    ) -> HeadingReading | None:
        """The heading to use."""
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
