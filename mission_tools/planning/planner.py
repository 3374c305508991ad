"""From a chart, a start and a goal to a plan."""

import contextlib
from collections.abc import Sequence
from dataclasses import replace

from companion.core.geo import Point
from mission_tools.errors import GoalBlocked, NoRoute, StartBlocked
from mission_tools.maps.chart import Chart
from mission_tools.planning.exact_planner import plan_exactly
from mission_tools.planning.plan_settings import Plan, PlanSettings

__all__ = ["Plan", "PlanSettings", "plan"]

_MARGIN_SHARES = (1.0, 0.5)
SAVED_M = 0.01
"""Mission files and MAVLink round positions to 1e-7 degrees: a waypoint moves by up to 0.008 m."""


def plan(
    chart: Chart, start: Point, goal: Point, settings: PlanSettings | None = None, via: Sequence[Point] = ()
) -> Plan:
    """Plan the shortest route from start through the via points to the goal, or one on a grid if asked for.

    Where the margin leaves no route, or a stop has less room, half of it is tried, then none; notes say so. A
    start that is afloat but nearer to a shore than the clearance (a boat at its jetty) is left straight for
    the nearest free water; the plan's notes say so. Raises StartBlocked, GoalBlocked: the place is on land,
    outside, kept out of or (not the start) too near to a shore; names the feature and the nearest free water.
    NoRoute: no water of the asked clearance joins them. UsageError: cells so small that the grid would not
    fit in memory.
    """
    settings = settings or PlanSettings()
    stops = (start, *via, goal)
    search = _plan_on_grid if settings.is_grid else plan_exactly
    spare_m = chart.clearance_m(start) - settings.clearance_m
    for share in _MARGIN_SHARES if settings.margin_m > 0.0 else ():
        tried = replace(settings, margin_m=share * settings.margin_m)
        if 0.0 <= spare_m < tried.margin_m:
            continue  # it is no boat at its jetty, that leaves without a clearance
        with contextlib.suppress(NoRoute, StartBlocked, GoalBlocked):
            found = search(chart, stops, tried)
            note = f"kept to {tried.required_m:g} m: no route keeps {settings.required_m:g} m"
            return replace(found, notes=(*found.notes, note)) if share < 1.0 else found
    if settings.margin_m == 0.0 and not settings.is_grid and not 0.0 <= spare_m < SAVED_M:
        with contextlib.suppress(NoRoute, StartBlocked, GoalBlocked):
            return replace(search(chart, stops, replace(settings, margin_m=SAVED_M)), settings=settings)
    found = search(chart, stops, replace(settings, margin_m=0.0))
    if settings.margin_m > 0.0:
        note = f"kept to {settings.clearance_m:g} m: there is no room for a margin beside it"
        found = replace(found, notes=(*found.notes, note))
    return found


def _plan_on_grid(chart: Chart, stops: Sequence[Point], settings: PlanSettings) -> Plan:
    from mission_tools.planning.grid_planner import plan_on_grid  # noqa: PLC0415  scipy takes long to import

    return plan_on_grid(chart, stops, settings)
