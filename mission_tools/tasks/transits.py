"""Routes and route lengths between the places of a task, on one chart with one clearance."""

import contextlib
import math
from collections.abc import Sequence

from companion.core.geo import Point, path_length_m
from companion.planning.visibility import NoWay
from mission_tools.errors import NoRouteError
from mission_tools.maps.chart import Chart
from mission_tools.planning.exact_planner import fitted, water_of
from mission_tools.planning.planner import PlanSettings, plan

_ROUNDING = 1e-9  # of the clearance: the ends of tracks lie at the clearance itself


class Transits:
    """Plans the way between two places, and remembers it."""

    def __init__(self, chart: Chart, settings: PlanSettings) -> None:
        self._chart = chart
        self._settings = settings
        self._routes = water_of(chart).routes(settings.required_m * (1.0 - _ROUNDING))
        self._found: dict[tuple[Point, Point], tuple[Point, ...] | NoRouteError] = {}

    def route(self, start: Point, goal: Point) -> tuple[Point, ...]:
        """The points of the way, both ends included.

        Raises:
            NoRouteError: there is none.
        """
        found = self._found.get((start, goal))
        if found is None:
            found = self._found[start, goal] = self._plan(start, goal)
            if not isinstance(found, NoRouteError):
                self._found.setdefault((goal, start), found[::-1])
        if isinstance(found, NoRouteError):
            raise found
        return found

    def lengths_m(self, start: Point, goals: Sequence[Point]) -> list[float]:
        """Of the way to each goal; infinite where there is none."""
        lengths = []
        for goal in goals:
            length_m = math.inf
            with contextlib.suppress(NoRouteError):
                length_m = path_length_m(self.route(start, goal))
            lengths.append(length_m)
        return lengths

    def _plan(self, start: Point, goal: Point) -> tuple[Point, ...] | NoRouteError:
        if start == goal:
            return (start,)
        with contextlib.suppress(NoWay):
            return fitted(self._routes.route(start, goal), self._routes, self._settings.required_m)
        try:  # with less of a margin, or from a jetty; else it says why not
            return plan(self._chart, start, goal, self._settings).points
        except NoRouteError as error:
            return error
