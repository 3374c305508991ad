"""What a metre of the way costs a boat: seconds, or charge, in the current that it meets there.

The boat holds its speed over ground as long as its thrusters reach, also in a wind (`windage.py`): through
the water it makes at most its top speed. To stay on a leg it points up against the current's part across it
(the wind triangle of navigation), and what is left of the top speed drives it along.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

from mission_tools.costs.current import STILL_WATER, Current
from mission_tools.costs.windage import InWind
from mission_tools.errors import MapError, UsageError
from mission_tools.maps.chart import SPEED_LIMIT, Chart, property_number

Floats = NDArray[np.float64]
SLOWEST_M_S = 0.1
SLOWEST_SHARE = 0.25
"""Over ground. A leg that leaves less, or less than this share of the speed asked for where that is slower
yet, counts as one that cannot be stemmed: a gust would stop the boat."""


@dataclass(frozen=True, slots=True)
class BoatSpeed:
    """What the boat asks of itself and what it can do.

    over_ground_m_s: its cruise speed. top_m_s: through the water, at full throttle. keep_m_s: the least speed
    through the water with steerage way, which it also keeps in a current that is faster than its cruise.
    wind: what it sails in, None: still air. Raises UsageError: not positive, or a cruise speed above the top
    speed.
    """

    over_ground_m_s: float = 2.0
    top_m_s: float = 3.0
    keep_m_s: float = 0.3
    wind: InWind | None = None

    def __post_init__(self) -> None:
        if not 0.0 < self.over_ground_m_s <= self.top_m_s < math.inf:
            raise UsageError(
                f"a speed of {self.over_ground_m_s:g} m/s over ground with a top speed of {self.top_m_s:g} "
                "m/s through the water: expected more than 0, and no more than the top speed"
            )

    def made_good_m_s(self, along_m_s: Floats, across_m_s: Floats, course_rad: Floats) -> Floats:
        """Speed over ground on a course, from the current along and across it; 0 where current or wind is too
        strong.
        """
        if self.wind is not None:
            speed = self.wind.made_good_m_s(
                self.over_ground_m_s, self.keep_m_s, along_m_s, across_m_s, course_rad
            )
        else:
            spare = self.top_m_s * self.top_m_s - across_m_s * across_m_s
            fastest = np.where(spare > 0.0, along_m_s + np.sqrt(np.maximum(spare, 0.0)), 0.0)
            speed = np.minimum(np.maximum(self.over_ground_m_s, along_m_s + self.keep_m_s), fastest)
        return np.where(speed >= min(SLOWEST_M_S, SLOWEST_SHARE * self.over_ground_m_s), speed, 0.0)

    def still_m_s(
        self, good_m_s: Floats, along_m_s: Floats, across_m_s: Floats, course_rad: Floats
    ) -> Floats:
        """The speed in still water and still air that draws as much as a speed made good."""
        if self.wind is not None:
            return self.wind.still_m_s(good_m_s, along_m_s, across_m_s, course_rad)
        return np.hypot(good_m_s - along_m_s, across_m_s)

    def too_strong(self, along_m_s: Floats, across_m_s: Floats, course_rad: Floats) -> str:
        """What keeps the boat from making way on one course."""
        if self.wind is None:
            return f"against the current at {self.top_m_s:g} m/s"
        wanted = np.full_like(course_rad, self.over_ground_m_s)
        if np.isinf(self.wind.still_m_s(wanted, along_m_s, across_m_s, course_rad)).all():
            return (
                f"before {self.wind.wind_m_s:g} m/s of wind: its gusts turn the boat across, harder than it "
                "can steer"
            )
        both = " and the current" if along_m_s.any() or across_m_s.any() else ""
        return f"in {self.wind.wind_m_s:g} m/s of wind{both} by a boat of {self.top_m_s:g} m/s"

    def at_most(self, limit_m_s: float) -> "BoatSpeed":
        """The same boat in a zone with a speed limit over ground."""
        return replace(self, over_ground_m_s=min(self.over_ground_m_s, limit_m_s))


class Travel(Protocol):
    """What a metre costs, for arrays of places and courses."""

    @property
    def unit(self) -> str:
        """Of the cost: s or mAh."""
        ...

    @property
    def varies(self) -> bool:
        """Whether it changes with time."""
        ...

    @property
    def pace(self) -> "Travel":
        """What a metre takes in seconds on the same terms."""
        ...

    def per_m(self, north_m: Floats, east_m: Floats, course_rad: Floats, time_s: Floats) -> Floats:
        """Cost of a metre over ground; infinite against too strong a current. time_s: on its clock."""
        ...


def _parts(
    current: Current, north_m: Floats, east_m: Floats, course_rad: Floats, time_s: Floats
) -> tuple[Floats, Floats]:
    """The current along a course, and across it to starboard."""
    north_m_s, east_m_s = current.at(north_m, east_m, time_s)
    cos, sin = np.cos(course_rad), np.sin(course_rad)
    return north_m_s * cos + east_m_s * sin, east_m_s * cos - north_m_s * sin


@dataclass(frozen=True, slots=True)
class TravelTime:
    """The cost is the time under way in seconds."""

    speed: BoatSpeed
    current: Current = STILL_WATER
    unit: str = "s"

    @property
    def varies(self) -> bool:
        return self.current.times is not None

    @property
    def pace(self) -> "TravelTime":
        return self

    def per_m(self, north_m: Floats, east_m: Floats, course_rad: Floats, time_s: Floats) -> Floats:
        """One over the speed made good."""
        along, across = _parts(self.current, north_m, east_m, course_rad, time_s)
        with np.errstate(divide="ignore"):
            return 1.0 / self.speed.made_good_m_s(along, across, course_rad)


@dataclass(frozen=True, slots=True)
class Charge:
    """Milliampere hours.

    drawn_a: what the whole boat draws at a speed through still water, m/s to A; for arrays.
    """

    speed: BoatSpeed
    drawn_a: Callable[[Floats], Floats]
    current: Current = STILL_WATER
    unit: str = "mAh"

    @property
    def varies(self) -> bool:
        return self.current.times is not None

    @property
    def pace(self) -> TravelTime:
        return TravelTime(self.speed, self.current)

    def per_m(self, north_m: Floats, east_m: Floats, course_rad: Floats, time_s: Floats) -> Floats:
        """The draw at the speed through the water that the leg needs, for the time that a metre takes."""
        along, across = _parts(self.current, north_m, east_m, course_rad, time_s)
        good = self.speed.made_good_m_s(along, across, course_rad)
        still = self.speed.still_m_s(good, along, across, course_rad)
        with np.errstate(divide="ignore"):
            return self.drawn_a(still) / good / 3.6


@dataclass(frozen=True, slots=True)
class OpenWater:
    """Another cost, raised near the shore: a soft preference for open water.

    room_m gives the distance to the nearest shore. A metre at the shore costs 1 + weight times as much as in
    open water, and 1 + weight / e at a distance of scale_m.
    """

    travel: Travel
    room_m: Callable[[Floats, Floats], Floats]
    weight: float
    scale_m: float

    @property
    def unit(self) -> str:
        return self.travel.unit

    @property
    def varies(self) -> bool:
        return self.travel.varies

    @property
    def pace(self) -> Travel:
        return self.travel.pace

    def per_m(self, north_m: Floats, east_m: Floats, course_rad: Floats, time_s: Floats) -> Floats:
        near = np.exp(-self.room_m(north_m, east_m) / self.scale_m)
        return self.travel.per_m(north_m, east_m, course_rad, time_s) * (1.0 + self.weight * near)


@dataclass(frozen=True, slots=True)
class SpeedZone:
    """An area, in east and north metres, and its speed limit over ground."""

    area: Polygon | MultiPolygon
    limit_m_s: float


@dataclass(frozen=True, slots=True)
class InZones:
    """Another cost, at the speed that each zone allows; where zones overlap the lowest counts."""

    travel: TravelTime | Charge
    zones: tuple[SpeedZone, ...]

    @property
    def unit(self) -> str:
        return self.travel.unit

    @property
    def varies(self) -> bool:
        return self.travel.varies

    @property
    def pace(self) -> Travel:
        return self if self.travel.pace is self.travel else replace(self, travel=self.travel.pace)

    def per_m(self, north_m: Floats, east_m: Floats, course_rad: Floats, time_s: Floats) -> Floats:
        cost = self.travel.per_m(north_m, east_m, course_rad, time_s)
        for zone in sorted(self.zones, key=lambda one: -one.limit_m_s):
            inside = shapely.contains_xy(zone.area, east_m, north_m)
            if inside.any():
                slow = replace(self.travel, speed=self.travel.speed.at_most(zone.limit_m_s))
                cost = np.where(inside, slow.per_m(north_m, east_m, course_rad, time_s), cost)
        return cost


def speed_zones(chart: Chart) -> tuple[SpeedZone, ...]:
    """The chart's areas with a speed limit. Raises MapError: a limit is no number above 0; names the area."""
    zones = []
    for feature in chart.features:
        limit_m_s = property_number(feature, SPEED_LIMIT)
        if limit_m_s is None or not isinstance(feature.shape, Polygon | MultiPolygon):
            continue
        if not limit_m_s > 0.0:
            raise MapError(f"{feature.described}: {SPEED_LIMIT} is {limit_m_s:g}: expected more than 0")
        zones.append(SpeedZone(feature.shape, limit_m_s))
    return tuple(zones)
