"""The top speed of a hull with two motors and with one, by simulation in calm water.

One motor turns the boat. Each strategy drives it full ahead until the heading has swung past one angle, then
astern until it has swung back past another. The best pair of angles counts.
"""

import math
from functools import cache
from itertools import product
from typing import Final

from sitl.world.drive.settings import ThrusterSettings
from sitl.world.drive.thruster import Thrusters
from sitl.world.hull import Hull
from sitl.world.hull_settings import HullSettings

_DT_S: Final = 0.05
_SETTLE_S: Final = 30.0
_MEASURE_S: Final = 60.0
_SWINGS_RAD: Final = (0.2, 0.5, 0.8, 1.2, 1.6, 2.2)


@cache
def top_speed_m_s(hull: HullSettings, drive: ThrusterSettings, supply_v: float) -> float:
    """With both motors."""
    body, thrusters = Hull(hull), Thrusters(drive)
    for _ in range(round(_MEASURE_S / _DT_S)):
        force_n, moment_nm = thrusters.step(1.0, 1.0, supply_v, body.surge_m_s, 0.0, _DT_S)
        body.step(force_n, 0.0, moment_nm, 0.0, 0.0, _DT_S)
    return body.surge_m_s


@cache
def one_motor_speed_m_s(hull: HullSettings, drive: ThrusterSettings, supply_v: float) -> float:
    """Made good with one motor dead, by the best way found."""
    return max(_made_good_m_s(hull, drive, supply_v, *swings) for swings in product(_SWINGS_RAD, repeat=2))


def _made_good_m_s(
    hull: HullSettings, drive: ThrusterSettings, supply_v: float, past_rad: float, back_rad: float
) -> float:
    body, thrusters, ahead = Hull(hull), Thrusters(drive), True
    from_n = from_e = 0.0
    begins = round(_SETTLE_S / _DT_S)
    for step in range(begins + round(_MEASURE_S / _DT_S)):
        if step == begins:
            from_n, from_e = body.north_m, body.east_m
        if ahead and body.heading_rad > past_rad:
            ahead = False
        elif not ahead and body.heading_rad < -back_rad:
            ahead = True
        force_n, moment_nm = thrusters.step(
            1.0 if ahead else -1.0, 0.0, supply_v, body.surge_m_s, body.yaw_rate_rad_s, _DT_S
        )
        body.step(force_n, 0.0, moment_nm, 0.0, 0.0, _DT_S)
    return math.hypot(body.north_m - from_n, body.east_m - from_e) / _MEASURE_S
