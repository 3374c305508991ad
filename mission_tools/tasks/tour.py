"""A tour: several places in the given or the best order, with a time to hold at each, there and back."""

import math
from collections.abc import Sequence

import numpy as np

from companion.core.geo import Point
from mission_tools.errors import NoRoute, NoRouteError, UsageError
from mission_tools.maps.chart import Chart
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.order import best_order
from mission_tools.tasks.task_route import Stop, TaskLeg, TaskRoute, joined
from mission_tools.tasks.transits import Transits


def tour(
    chart: Chart,
    start: Point,
    stops: Sequence[Stop],
    settings: PlanSettings | None = None,
    *,
    any_order: bool = False,
    is_return: bool = False,
) -> TaskRoute:
    """The route from start to every stop, one leg each.

    any_order: the stops in the order that makes the route shortest (with the way back, where is_return),
    measured along the true routes; otherwise as given. is_return: back to the start at the end.

    Raises:
        UsageError: no stops.
        NoRouteError: the start is no place for a boat, or a stop cannot be reached; names every such stop.
    """
    if not stops:
        raise UsageError("a tour needs at least one place to sail to")
    transits = Transits(chart, settings or PlanSettings())
    _check_reachable(transits, start, stops)
    order: Sequence[int] = range(len(stops))
    if any_order:
        places = [start, *(stop.place for stop in stops)]
        lengths_m = np.array([transits.lengths_m(place, places) for place in places])
        order = [number - 1 for number in best_order(lengths_m, is_return=is_return)]
    legs, here = [], start
    for number in order:
        stop = stops[number]
        legs.append(TaskLeg("transit", transits.route(here, stop.place), stop.hold_s))
        here = stop.place
    if is_return:
        legs.append(TaskLeg("transit", transits.route(here, start)))
    return joined(legs)


def stop_name(stops: Sequence[Stop], number: int) -> str:
    """What messages call a stop."""
    return stops[number].name or ("the goal" if len(stops) == 1 else f"stop {number + 1}")


def _check_reachable(transits: Transits, start: Point, stops: Sequence[Stop]) -> None:
    """Every stop must be reachable from the start; all that are not are named in one error."""
    lengths_m = transits.lengths_m(start, [stop.place for stop in stops])
    unreachable = [number for number, length_m in enumerate(lengths_m) if math.isinf(length_m)]
    failures = []
    for number in unreachable:
        try:
            transits.route(start, stops[number].place)
        except NoRouteError as error:
            failures.append(error)
    if len(failures) == 1 or (failures and len(failures) == len(stops) > 1 and _are_same(failures)):
        raise failures[0]
    if failures:
        named = "; ".join(
            f"{stop_name(stops, number)}: {error}"
            for number, error in zip(unreachable, failures, strict=True)
        )
        raise NoRoute(f"{len(failures)} of {len(stops)} stops cannot be reached: {named}")


def _are_same(failures: Sequence[NoRouteError]) -> bool:
    """Whether all fail for one reason, such as a start ashore."""
    return len({str(error) for error in failures}) == 1
