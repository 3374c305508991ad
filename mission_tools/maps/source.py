"""What is planned on: a chart, the route that its scenario proposes, and its cases."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from companion.core.geo import Point
from mission_tools.errors import UsageError
from mission_tools.maps.chart import Chart


@dataclass(frozen=True, slots=True)
class RouteDefaults:
    """What a scenario says about its route; None where it says nothing."""

    start: Point | None = None
    goal: Point | None = None
    via: tuple[Point, ...] = ()
    clearance_m: float | None = None
    margin_m: float | None = None
    cell_m: float | None = None
    heuristic: str | None = None
    smooth: bool | None = None


@dataclass(frozen=True, slots=True)
class Source:
    """A chart with the route that its scenario proposes, and its named cases (start, goal)."""

    chart: Chart
    route: RouteDefaults = RouteDefaults()
    cases: Mapping[str, tuple[Point, Point]] = field(default_factory=dict)

    def with_case(self, name: str) -> "Source":
        """The same source with a case's start and goal. Raises UsageError: no case of that name."""
        if name not in self.cases:
            known = ", ".join(self.cases) or "none"
            raise UsageError(f"no case {name!r} in {self.chart.name}: there are {known}")
        start, goal = self.cases[name]
        return replace(self, route=replace(self.route, start=start, goal=goal, via=()))
