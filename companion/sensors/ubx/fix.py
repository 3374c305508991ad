"""Combines UBX messages into fixes."""

import math
from typing import Final

from companion.core.readings import GnssFix
from companion.sensors.receiver_clock import ReceiverClock
from companion.sensors.ubx.frames import NAV_DOP, NAV_PVT, UbxFrame
from companion.sensors.ubx.messages import horizontal_dop, solution

_DAY_S: Final = 86_400.0
_DOP_LIFE_S: Final = 2.0


class UbxFixAssembler:
    """A NAV-PVT is a fix; the horizontal DOP is that of the latest NAV-DOP."""

    def __init__(self, latency_s: float) -> None:
        """latency_s: shortest time from measurement to arrival."""
        self._clock = ReceiverClock(latency_s)
        self._hdop, self._hdop_s = 99.99, -math.inf

    def feed(self, frame: UbxFrame, time_s: float) -> GnssFix | None:
        """Process a frame that arrived at time_s."""
        if frame.kind == NAV_DOP and (hdop := horizontal_dop(frame.payload)) is not None:
            self._hdop, self._hdop_s = hdop, time_s
        if frame.kind != NAV_PVT or (pvt := solution(frame.payload)) is None:
            return None
        has_velocity = pvt.fix_type > 1
        # The position DOP is an upper bound of the horizontal one.
        hdop = self._hdop if time_s - self._hdop_s <= _DOP_LIFE_S else pvt.position_dop
        return self._clock.stamp(
            GnssFix(
                time_s=time_s,
                position=pvt.position,
                fix_type=pvt.fix_type,
                satellites=pvt.satellites,
                hdop=hdop,
                north_m_s=pvt.north_m_s if has_velocity else None,
                east_m_s=pvt.east_m_s if has_velocity else None,
                altitude_m=pvt.altitude_m,
                horizontal_accuracy_m=pvt.horizontal_accuracy_m,
                unix_time_s=pvt.unix_time_s,
                time_of_day_s=pvt.time_of_week_s % _DAY_S,
                vertical_accuracy_m=pvt.vertical_accuracy_m,
                speed_accuracy_m_s=pvt.speed_accuracy_m_s,
                correction_age_s=pvt.correction_age_s,
            )
        )
