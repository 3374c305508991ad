"""Moving obstacles: swimmers, other boats, drifting logs, each a circle on a path of its own.

Where a mover is, is a function of time alone, so that nothing needs to be stepped.
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section
from companion.core.units import wrap_pi

East_North = tuple[float, float]


class MoverSettings(Section, frozen=True):
    """One of [[movers]] of a scenario. Positions are [east, north] in metres.

    It is at start until at_s. Then it goes from waypoint to waypoint at speed_m_s, and stops at the last one
    or, with loop, goes back to start and round again; without waypoints it goes straight on at velocity_m_s,
    [east, north]. ais: the class of its transponder. Raises ValueError: both waypoints and a velocity, or
    waypoints without a speed.
    """

    start: East_North
    radius_m: Positive = 0.5
    at_s: NonNegative = 0.0
    velocity_m_s: East_North = (0.0, 0.0)
    waypoints: Annotated[tuple[East_North, ...], Meta(max_length=1000)] = ()
    speed_m_s: NonNegative = 0.0
    loop: bool = False
    ais: Literal["none", "A", "B"] = "none"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.waypoints and self.velocity_m_s != (0.0, 0.0):
            raise ValueError("velocity_m_s: expected either a velocity or waypoints with a speed_m_s")
        if self.waypoints and not self.speed_m_s:
            raise ValueError("speed_m_s: expected more than 0 where there are waypoints")


class Mover:
    """One of them."""

    def __init__(self, settings: MoverSettings) -> None:
        self.settings = settings
        corners = [settings.start, *settings.waypoints]
        if settings.loop:
            corners.append(settings.start)
        self._corners = corners
        self._passed_m = [0.0, *accumulate(math.dist(a, b) for a, b in pairwise(corners))]

    def position_m(self, time_s: float) -> East_North:
        """East and north at a time."""
        settings = self.settings
        under_way_s = max(0.0, time_s - settings.at_s)
        if not settings.waypoints:
            (east, north), (v_east, v_north) = settings.start, settings.velocity_m_s
            return east + v_east * under_way_s, north + v_north * under_way_s
        gone_m, whole_m = under_way_s * settings.speed_m_s, self._passed_m[-1]
        if settings.loop and whole_m > 0.0:
            gone_m %= whole_m
        if gone_m >= whole_m:
            return self._corners[-1]
        leg = bisect_right(self._passed_m, gone_m) - 1
        (from_east, from_north), (to_east, to_north) = self._corners[leg], self._corners[leg + 1]
        share = (gone_m - self._passed_m[leg]) / (self._passed_m[leg + 1] - self._passed_m[leg])
        return from_east + share * (to_east - from_east), from_north + share * (to_north - from_north)


class Movers:
    """All of them."""

    def __init__(self, settings: Sequence[MoverSettings]) -> None:
        self._movers = tuple(Mover(one) for one in settings)

    def __bool__(self) -> bool:
        return bool(self._movers)

    @property
    def transponders(self) -> list[str]:
        """The class of each one's AIS."""
        return [one.settings.ais for one in self._movers]

    def positions_m(self, time_s: float) -> list[tuple[float, float, float]]:
        """East, north and radius of each at a time."""
        return [(*one.position_m(time_s), one.settings.radius_m) for one in self._movers]

    def gap_m(self, east_m: float, north_m: float, time_s: float) -> float:
        """How far a point is from the nearest one's edge, negative inside; infinite when there is none."""
        gaps = [
            math.hypot(east_m - east, north_m - north) - radius
            for east, north, radius in self.positions_m(time_s)
        ]
        return min(gaps, default=math.inf)

    def echoes(
        self,
        east_m: float,
        north_m: float,
        bearing_rad: float,
        cone_rad: float,
        max_range_m: float,
        time_s: float,
    ) -> list[tuple[float, float, float]]:
        """Range, radius and angle off the bearing of each mover that a cone about a bearing meets, as far as
        the cone's ray nearest to its middle. A cone of 0 is a single ray.
        """
        out = []
        for east, north, radius_m in self.positions_m(time_s):
            to_east, to_north = east - east_m, north - north_m
            away_m = math.hypot(to_east, to_north)
            range_m, off_rad = 0.0, 0.0
            if away_m > radius_m:
                aside_rad = abs(wrap_pi(math.atan2(to_east, to_north) - bearing_rad))
                off_rad = max(0.0, aside_rad - math.asin(radius_m / away_m))
                if off_rad > cone_rad:
                    continue
                off_middle_m = away_m * math.sin(max(0.0, aside_rad - cone_rad))
                range_m = math.sqrt(away_m**2 - off_middle_m**2)
                range_m -= math.sqrt(max(radius_m**2 - off_middle_m**2, 0.0))
            if range_m <= max_range_m:
                out.append((range_m, radius_m, off_rad))
        return out
