"""The pack: low, critical, and too little left for the way home."""

import math
from typing import TYPE_CHECKING

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.state import NavState
from companion.sensors.charge import resting_share
from companion.sensors.readings import BatteryReading

if TYPE_CHECKING:
    from companion.failsafe.inputs import FailsafeInputs

_SAILING_M_S = 0.3  # through the water: slower says nothing about what sailing takes
_LEARN_S = 30.0
_ENOUGH_S = 20.0  # of sailing before anything is said
_SLOWEST_SHARE = 0.1  # of the speed through the water: what is left of it against the set, at the least
_NEAR_M = 10.0  # home is there already


class Endurance:
    """How far the charge lasts: what sailing has drawn lately, how fast it went, what the pack began with.

    The pack's charge at boot is read from its resting voltage, before the motors have ever turned; after that
    charge is counted.
    """

    __slots__ = ("_begun_share", "_sailed_s", "draw_a", "water_speed_m_s")

    def __init__(self) -> None:
        self.draw_a = 0.0
        self.water_speed_m_s = 0.0
        self._sailed_s = 0.0
        self._begun_share = math.nan

    def renew(self, share: float) -> None:
        """The pack has been changed or charged: it begins with this share of its charge."""
        self._begun_share = share

    def learn(
        self, battery: BatteryReading | None, nav: NavState | None, config: BoatConfig, dt_s: float
    ) -> None:
        """Take what the last dt_s have drawn."""
        if battery is None:
            return
        if math.isnan(self._begun_share):
            self._begun_share = resting_share(battery.voltage_v / config.battery.cells)
        if nav is None or battery.current_a is None or not battery.current_a > 0.0:
            return
        speed = math.hypot(nav.north_m_s - nav.current_north_m_s, nav.east_m_s - nav.current_east_m_s)
        if not speed > _SAILING_M_S:
            return
        self._sailed_s += dt_s
        share = dt_s / min(self._sailed_s, _LEARN_S)
        self.draw_a += share * (battery.current_a - self.draw_a)
        self.water_speed_m_s += share * (speed - self.water_speed_m_s)

    def left_mah(self, consumed_mah: float, config: BoatConfig) -> float:
        """Charge that may still be used, the reserve left out."""
        usable = self._begun_share - config.failsafe.range_reserve
        return usable * config.battery.capacity_mah - consumed_mah

    def way_home_mah(self, nav: NavState, home: Point) -> float:
        """What the straight way home takes, against the set of now; NaN while too little has been sailed."""
        north, east = home.north_m - nav.north_m, home.east_m - nav.east_m
        distance = math.hypot(north, east)
        if self._sailed_s < _ENOUGH_S or distance < _NEAR_M:
            return math.nan
        water = self.water_speed_m_s
        along = (north * nav.current_north_m_s + east * nav.current_east_m_s) / distance
        across = (north * nav.current_east_m_s - east * nav.current_north_m_s) / distance
        made_good = along + math.sqrt(max(water * water - across * across, 0.0))
        seconds = distance / max(made_good, _SLOWEST_SHARE * water)
        return self.draw_a * seconds / 3.6


def battery_low(signs: "FailsafeInputs") -> str:
    """Below BATT_LOW_VOLT."""
    return _below(signs, signs.config.failsafe.battery_low_v, "low")


def battery_critical(signs: "FailsafeInputs") -> str:
    """Below BATT_CRT_VOLT."""
    return _below(signs, signs.config.failsafe.battery_critical_v, "critical")


def _below(signs: "FailsafeInputs", limit_v: float, what: str) -> str:
    battery = signs.battery
    if battery is None or limit_v <= 0.0 or not battery.voltage_v < limit_v:
        return ""
    return f"Battery {what}: {battery.voltage_v:.1f} V"


def out_of_range(signs: "FailsafeInputs") -> str:
    """The point of no return, as it was found when last looked for."""
    return signs.shortfall


def shortfall(signs: "FailsafeInputs") -> str:
    """Whether what is left of the charge will soon no longer take the boat home, in words."""
    nav, home, battery = signs.nav, signs.home, signs.battery
    if nav is None or home is None or battery is None or battery.current_a is None:
        return ""
    config = signs.config
    straight_m = math.hypot(home.north_m - nav.north_m, home.east_m - nav.east_m)
    need_mah = config.failsafe.range_margin * signs.endurance.way_home_mah(nav, home)
    if straight_m < signs.home_distance_m < math.inf:  # the water goes round corners
        need_mah *= signs.home_distance_m / max(straight_m, 1.0)
    left_mah = signs.endurance.left_mah(signs.consumed_mah, config)
    if not left_mah < need_mah:
        return ""
    return f"Point of no return: {left_mah:.0f} mAh left, {need_mah:.0f} wanted for the way home"
