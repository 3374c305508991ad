"""What the wind asks of the thrusters: the balance of forces on a boat that holds its speed over ground.

In steady motion (T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd edition,
Wiley 2021) the thrust is the hull's drag at its speed through the water, less the wind's push along the bow
(chapter 10.1, symmetrical ships, V the speed of the air past the hull and γ its angle off the bow)

    X = −½ ρ V² c_x cos γ A_F        Y = ½ ρ V² c_y sin γ A_L        N = ½ ρ V² c_n sin 2γ A_L L

plus what the side force Y costs: the hull makes leeway at the angle β = Y / k u² until its lift balances
the wind, k = ½ π ρ T² (a slender wing: R. T. Jones, NACA Report 835, 1946), and Y β is the drag that comes
with it. The boat steers against N and against Y, which acts abaft the hull's centre of lateral resistance:
from abaft both turn the bow into the wind. What neither two motors nor a rudder can hold broaches.

The drag grows with u^1.8 (turbulent friction, C_F ∝ Re^−0.2). Thrust follows the bilinear model of a
propeller (chapter 9) with the shaft's speed n proportional to the drive: T = T_0 n² − (T_0 − T_1) n u / u_1
between the pull at rest T_0 and the thrust T_1 at the top speed u_1. So each load is the same drive, and
nearly the same draw, as some speed in still water and still air; that speed stands for it everywhere else.
"""

import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from companion.config.actuators import Windage
from companion.config.boat_config import BoatConfig
from mission_tools.errors import UsageError

Floats = NDArray[np.float64]
AIR_KG_M3, WATER_KG_M3 = 1.225, 1000.0
FRONTAL_DRAG, LATERAL_DRAG, TURNING = 0.8, 0.9, 0.1
"""c_x, c_y and c_n. Fossen gives 0.5 to 0.9, 0.7 to 0.95 and 0.05 to 0.2; boxes and masts are no streamlined
superstructure, and stand for the upper part of the range."""
GUSTS = 1.04
"""The mean square of a wind over the square of its mean, for turbulence of 20 % as near the water."""
PEAK_SHARE = 0.4
"""How much faster than its mean a wind is in gusts of two standard deviations, in which a boat broaches."""
LATERAL_CENTRE = 0.1
"""How far ahead of amidships the hull's side force acts, in lengths."""
WANDER = 0.5
"""Sine of the angle by which the bow may leave a following wind before it is caught: 30°."""
DRAG_EXPONENT = 1.8
TOP_SHARE, STEERING_SHARE = 0.7, 0.33
"""Of the pull at rest: the thrust at top speed, and what two motors keep for steering at full throttle. The
first is 0.53 to 0.8 for five emulated hulls; the second, and the next, are fitted to the kit boat in 4 m/s
from ahead and the catamaran in 8 m/s from astern (`benchmarks.planning.voyages`, seeds 1001 to 1003)."""
STEERING_COST = 0.3
"""Of the difference of two motors' thrusts: what it takes like thrust ahead."""
ASTERN_SHARE = 0.6
"""Of a propeller's pull, astern."""
RUDDER_SHARE = 0.02
"""Area of a rudder, of length times draught (Molland and Turnock, *Marine Rudders and Control Surfaces*,
2007, small craft); its lift coefficient is 1 where it stalls."""
MOST_LEEWAY_RAD = 0.5
_STEPS, _SPEEDS = 25, 401  # of the speeds that are tried, and of those of the drive in still water,
_FASTEST_SHARE = 4.0  # which go that far beyond the top speed
_FORM = re.compile(r"\s*(\d+\.?\d*|\.\d+)\s*@\s*([+-]?(?:\d+\.?\d*|\.\d+))\s*", re.ASCII)
_FASTEST_M_S = 40.0


@dataclass(frozen=True, slots=True)
class InWind:
    """A boat in a wind that blows to north_m_s, east_m_s. top_m_s: through the water. arm_m: of each of two
    motors that steer; 0: a rudder does.
    """

    windage: Windage
    top_m_s: float
    arm_m: float
    has_rudder: bool
    north_m_s: float
    east_m_s: float

    @property
    def wind_m_s(self) -> float:
        return math.hypot(self.north_m_s, self.east_m_s)

    def still_m_s(
        self, good_m_s: Floats, along_m_s: Floats, across_m_s: Floats, course_rad: Floats
    ) -> Floats:
        """The speed in still water and still air that takes the same drive as a speed made good on a course,
        in a current along and across it. Beyond the top speed: more than full throttle. Infinite: steering
        is lost, as the gusts from abaft turn the boat harder than it can steer.
        """
        hull, air = self.windage, 0.5 * AIR_KG_M3
        ahead, aside = good_m_s - along_m_s, -across_m_s
        through = np.maximum(np.hypot(ahead, aside), 1e-3 * self.top_m_s)
        cos, sin = np.cos(course_rad), np.sin(course_rad)
        air_along = self.north_m_s * cos + self.east_m_s * sin - good_m_s
        air_across = self.east_m_s * cos - self.north_m_s * sin
        astern = (air_along * ahead + air_across * aside) / through  # from astern; from ahead it is negative
        abeam = np.abs(air_across * ahead - air_along * aside) / through
        speed = GUSTS * np.hypot(astern, abeam)
        side_n = air * LATERAL_DRAG * hull.lateral_area_m2 * speed * abeam
        lift_n = 0.5 * math.pi * WATER_KG_M3 * (hull.draught_m * through) ** 2  # per radian of leeway
        gained = speed * astern + GUSTS * through**2  # over still air
        thrust_n = self._drag_n(through) - air * FRONTAL_DRAG * hull.frontal_area_m2 * gained
        thrust_n += side_n * np.minimum(side_n / lift_n, MOST_LEEWAY_RAD)
        gust = astern + PEAK_SHARE * self.wind_m_s
        is_lost = (astern > abeam) & (self._turned_nm(gust, abeam) > self._most_turned_nm(through))
        if self.arm_m > 0.0:
            difference_n = GUSTS * self._turned_nm(astern, abeam) / self.arm_m
            thrust_n = np.hypot(np.maximum(thrust_n, 0.0), STEERING_COST * difference_n)
        speeds = np.linspace(0.0, _FASTEST_SHARE * self.top_m_s, _SPEEDS)
        drives = self._drive(speeds, self._drag_n(speeds))
        return np.where(is_lost, np.inf, np.interp(self._drive(through, thrust_n), drives, speeds))

    def made_good_m_s(
        self, wanted_m_s: float, keep_m_s: float, along_m_s: Floats, across_m_s: Floats, course_rad: Floats
    ) -> Floats:
        """The speed over ground that the boat makes: the wanted one, or with keep_m_s through the water in a
        faster current; where that is too fast, the fastest one below it; 0 where there is none. (A boat that
        is too slow makes leeway, so that the drive has no single solution.)
        """
        good = np.maximum(along_m_s + keep_m_s, wanted_m_s)
        over = self.still_m_s(good, along_m_s, across_m_s, course_rad) - self.top_m_s
        found = np.where(over <= 0.0, good, 0.0)
        for share in np.linspace(1.0, 0.0, _STEPS)[1:] if (over > 0.0).any() else ():
            before = np.minimum(over, _FASTEST_M_S)  # also of a boat that cannot steer
            over = self.still_m_s(share * good, along_m_s, across_m_s, course_rad) - self.top_m_s
            part = np.clip(over / np.minimum(over - before, -1e-9), 0.0, 1.0)  # towards the faster one
            slower = (share + part / (_STEPS - 1)) * good
            found = np.where((found == 0.0) & (over <= 0.0), slower, found)
        return found

    def _drag_n(self, through_m_s: Floats) -> Floats:
        """At a speed through still water and still air."""
        drag: Floats = TOP_SHARE * self.windage.pull_n * (through_m_s / self.top_m_s) ** DRAG_EXPONENT
        return drag

    def _drive(self, through_m_s: Floats, thrust_n: Floats) -> Floats:
        """The drive that gives a thrust at a speed through the water, 1 at full throttle."""
        rest_n = self.windage.pull_n * (1.0 - STEERING_SHARE if self.arm_m > 0.0 else 1.0)
        lost_n = (rest_n - TOP_SHARE * self.windage.pull_n) * through_m_s / self.top_m_s
        drive: Floats = lost_n + np.sqrt(np.maximum(lost_n**2 + 4.0 * rest_n * thrust_n, 0.0))
        return drive / (2.0 * rest_n)

    def _most_turned_nm(self, through_m_s: Floats) -> Floats:
        """The moment of two motors, one ahead and one astern, and of a rudder."""
        rudder_m3 = RUDDER_SHARE * self.windage.length_m**2 * self.windage.draught_m * self.has_rudder
        pair_nm = 0.5 * self.windage.pull_n * (1.0 + ASTERN_SHARE) * self.arm_m
        return pair_nm + 0.25 * WATER_KG_M3 * rudder_m3 * through_m_s**2

    def _turned_nm(self, astern_m_s: Floats, abeam_m_s: Floats) -> Floats:
        """The moment that turns the bow into a wind from astern and from abeam, past the hull."""
        side = np.maximum(abeam_m_s, WANDER * astern_m_s)
        turns = 2.0 * TURNING * astern_m_s
        turns += LATERAL_CENTRE * LATERAL_DRAG * np.hypot(astern_m_s, abeam_m_s)
        return 0.5 * AIR_KG_M3 * self.windage.lateral_area_m2 * self.windage.length_m * side * turns


def in_wind(config: BoatConfig, top_m_s: float, text: str, boat: str) -> InWind:
    """A boat, by its name, in a wind such as 6@270: speed, and where it comes from. Raises UsageError: no
    such form, or a boat of unknown windage.
    """
    form, one, drive = _FORM.fullmatch(text), config.windage, config.drive
    if form is None or float(form[1]) > _FASTEST_M_S:
        raise UsageError(
            f"--wind '{text}': expected M_S@FROM, such as 6@270: the mean wind in m/s at the height of the "
            f"hull, up to {_FASTEST_M_S:g}, and where it comes from in degrees"
        )
    if not (one.frontal_area_m2 > 0.0 and one.lateral_area_m2 > 0.0 and one.pull_n > 0.0):
        raise UsageError(
            f"--wind: {boat} does not say its windage: set frontal_area_m2, lateral_area_m2 and pull_n in "
            "[windage] of its file, see docs/planner.md"
        )
    wind_m_s, from_rad = float(form[1]), math.radians(float(form[2]))
    north_m_s, east_m_s = -wind_m_s * math.cos(from_rad), -wind_m_s * math.sin(from_rad)
    arm_m = 0.5 * one.apart_m * drive.has_pair
    return InWind(one, top_m_s, arm_m, drive.has_rudder, north_m_s, east_m_s)
