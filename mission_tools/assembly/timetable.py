"""When a route passes its waypoints, and which departure is best."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from companion.core.geo import Point, path_length_m
from mission_tools.costs.departure import Departure, KnownTimes, iso, time_said
from mission_tools.costs.legs import leg_costs, route_costs
from mission_tools.costs.travel import Travel
from mission_tools.errors import NoRoute
from mission_tools.wording import duration

TRIED_DEPARTURES = 49  # of a window: a quarter of an hour apart in half a day
LATER_S, LATER_STEP_S = 25.0 * 3600.0, 300.0  # where else a departure is looked for; a lunar day is 24.84 h
_MOST_SAID = 12  # waypoints in a line of output
_SAMPLES = 250  # along a route


class Tried(NamedTuple):
    """A departure of a window. cost: in the table's unit; infinite: cannot be sailed then."""

    depart_s: float
    arrive_s: float
    cost: float


@dataclass(frozen=True, slots=True)
class Timetable:
    """Times on the current's clock: since 1970 (UTC) if is_dated.

    arrive_s: at each waypoint. wait_s: how much later than asked it departs, as the current is too strong
    before. tried: the departures of a window, and unit that of their costs.
    """

    depart_s: float
    arrive_s: tuple[float, ...]
    is_dated: bool = False
    wait_s: float = 0.0
    tried: tuple[Tried, ...] = ()
    unit: str = "s"

    def sailed(self, under_way_s: Sequence[float]) -> "Timetable":
        """The same departure with better known times under way, such as a budget's, turns included."""
        return replace(self, arrive_s=tuple(self.depart_s + at_s for at_s in under_way_s))

    def notes(self, times: KnownTimes | None) -> tuple[str, ...]:
        """What to say where it goes beyond the times for which the current is known."""
        return times.note(self.depart_s, self.arrive_s[-1]) if times else ()

    def said(self, time_s: float) -> str:
        """A time on the way for people: of the day, or after how long."""
        if not self.is_dated:
            return duration(time_s - self.depart_s)
        day, at = iso(time_s).split("T")
        return at if iso(self.depart_s).startswith(day) else f"{day} {at}"

    @property
    def span(self) -> str:
        """How long it is under way, and from when."""
        said = f"{duration(self.arrive_s[-1] - self.depart_s)} under way"
        if self.is_dated or self.tried or self.wait_s:
            said += f", leaves {time_said(self.depart_s, is_dated=self.is_dated)}"
        return said

    def departure_said(self, one: Tried) -> str:
        """A departure and what it costs."""
        said = "cannot be sailed"
        if one.cost < math.inf:
            said = duration(one.cost) if self.unit == "s" else f"{one.cost:.0f} mAh"
        return f"{time_said(one.depart_s, is_dated=self.is_dated)}, {said}"

    def lines(self) -> list[str]:
        """Departure and arrivals as lines of output."""
        passed = [f"{n} {self.said(at_s)}" for n, at_s in enumerate(self.arrive_s, 1)]
        lines = [
            f"times: {self.span}; waypoint {', '.join(passed if len(passed) <= _MOST_SAID else passed[-1:])}"
        ]
        if self.wait_s:
            lines.append(f"leaves {duration(self.wait_s)} later than asked: the current is too strong before")
        can = [one for one in self.tried if one.cost < math.inf]
        if can:
            worst = self.departure_said(max(can, key=lambda one: one.cost))
            barred = len(self.tried) - len(can)
            lines.append(
                f"best of {len(self.tried)} departures, {barred} against too strong a current; worst: {worst}"
            )
        return lines

    def as_json(self) -> dict[str, object]:
        """Plain values: null for what cannot be sailed; dates in UTC where the clock has dates."""

        def plain(time_s: float) -> str | float:
            return iso(time_s) if self.is_dated else time_s

        return {
            "depart": plain(self.depart_s),
            "arrive": [plain(at_s) for at_s in self.arrive_s],
            "under_way_s": self.arrive_s[-1] - self.depart_s,
            "wait_s": self.wait_s,
            "unit": self.unit,
            "departures": [
                [
                    plain(one.depart_s),
                    *((plain(one.arrive_s), one.cost) if one.cost < math.inf else (None, None)),
                ]
                for one in self.tried
            ],
        }


def spacing_m(points: Sequence[Point]) -> float:
    """Between the samples along a route."""
    return max(path_length_m(points) / _SAMPLES, 0.25)


def tried_of(
    travel: Travel, routes: Sequence[Sequence[Point]], departure: Departure, holds_s: Sequence[float] = ()
) -> tuple[Tried, ...]:
    """What the best of some routes costs for each departure of a window, without waits."""
    depart_s = np.linspace(departure.begin_s, departure.latest_s, TRIED_DEPARTURES)
    found = [route_costs(travel, points, spacing_m(points), depart_s, holds_s) for points in routes]
    cost, arrive_s = np.stack([one[0] for one in found]), np.stack([one[1][-1] for one in found])
    best, each = np.argmin(cost, axis=0), np.arange(len(depart_s))
    rows = np.stack((depart_s, arrive_s[best, each], cost[best, each]), axis=1)
    return tuple(Tried(*row) for row in rows.tolist())


def fixed_route(
    travel: Travel, points: Sequence[Point], departure: Departure, holds_s: Sequence[float] = ()
) -> Timetable:
    """The timetable of a route as it is, by the best departure of a window. holds_s: at the start and at each
    waypoint. Raises NoRoute: a leg that cannot be sailed then; says when it could.
    """
    tried: tuple[Tried, ...] = ()
    depart_s = departure.begin_s
    if departure.is_window:
        tried = tried_of(travel, [points], departure, holds_s)
        depart_s = min(tried, key=lambda one: one.cost).depart_s
    now_s, arrive_s = depart_s, []
    for number, (a, b) in enumerate(pairwise(points)):
        now_s += holds_s[number] if holds_s else 0.0
        taken = float(leg_costs(travel.pace, [a], [b], spacing_m(points), now_s)[0][0])
        if not math.isfinite(taken):
            said = f"leg {number + 1} cannot be sailed against current or wind"
            raise NoRoute(said + _until(travel, points, departure, holds_s, now_s))
        now_s += taken
        arrive_s.append(now_s)
    return Timetable(depart_s, tuple(arrive_s), departure.is_dated, tried=tried, unit=travel.unit)


def _until(
    travel: Travel, points: Sequence[Point], departure: Departure, holds_s: Sequence[float], at_s: float
) -> str:
    """When a leg cannot be sailed, and which departure would do; nothing where that never changes."""
    if not travel.varies:
        return ""
    is_dated = departure.is_dated
    said = f" at {time_said(at_s, is_dated=is_dated)}"
    later_s = np.arange(departure.latest_s, departure.latest_s + LATER_S, LATER_STEP_S)
    can = np.isfinite(route_costs(travel, points, spacing_m(points), later_s, holds_s)[0])
    if not can.any():
        return f"{said}, nor by leaving within {LATER_S / 3600.0:.0f} h after that"
    first_s = float(later_s[np.argmax(can)])
    return f"{said}; the route can be sailed with --depart {iso(first_s) if is_dated else f'{first_s:.0f}'}"
