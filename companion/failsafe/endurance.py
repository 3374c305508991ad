"""How far the charge lasts, and whether it takes the boat home."""

import math

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.readings import BatteryReading
from companion.core.state import NavState
from companion.sensors.fuel_gauge import resting_share

_PERIOD_S = 1.0  # between two comparisons of the charge with the way home
_SAILING_M_S = 0.3  # through the water: a slower boat says nothing about what sailing draws
_LEARN_S = 30.0  # time constant of draw and speed: several corners and gusts
_ENOUGH_S = 20.0  # of sailing before the draw counts as known
_SLOWEST_SHARE = 0.1  # of the speed through the water: the least that is left of it against the current
_NEAR_M = 10.0  # nearer than this the boat is home


class Endurance:
    """The charge left, and what sailing draws and how fast it goes, averaged over the last half minute.

    The pack's charge at boot is read from its resting voltage, before the motors turn; from then on it is
    counted. range_fault: why the charge does not take the boat home, "" while it does.
    """

    def __init__(self) -> None:
        self.range_fault = ""
        self._due_s = 0.0
        self.draw_a = 0.0
        self.water_speed_m_s = 0.0
        self._sailed_s = 0.0
        self._begun_share = math.nan

    def renew(self, share: float) -> None:
        """The pack has been changed or charged: it begins with this share of its charge."""
        self._begun_share = share
        self.range_fault = ""

    def compare(
        self,
        nav: NavState | None,
        home: Point | None,
        home_distance_m: float,
        battery: BatteryReading | None,
        consumed_mah: float,
        config: BoatConfig,
        now_s: float,
    ) -> None:
        """Compare the charge with the way home. home_distance_m: by the water, infinite while unknown."""
        self._due_s = now_s + _PERIOD_S
        self.range_fault = ""
        if nav is None or home is None or battery is None or battery.current_a is None:
            return
        straight_m = math.hypot(home.north_m - nav.north_m, home.east_m - nav.east_m)
        need_mah = config.failsafe.range_margin * self.way_home_mah(nav, home)
        if straight_m < home_distance_m < math.inf:  # the water goes round corners
            need_mah *= home_distance_m / max(straight_m, 1.0)
        left_mah = self.left_mah(consumed_mah, config)
        if left_mah < need_mah:
            self.range_fault = f"Point of no return: {left_mah:.0f} mAh, {need_mah:.0f} needed"

    def is_due(self, now_s: float) -> bool:
        """Whether it is time to compare."""
        return now_s >= self._due_s

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
        """Charge for the straight way home in the present current; NaN while the draw is not known."""
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
