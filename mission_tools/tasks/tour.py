"""A tour: several places in the given or the best order, with a time to hold at each, there and back.

Up to EXACT_STOPS places the order is found by dynamic programming over subsets (M. Held and R. M. Karp, "A
dynamic programming approach to sequencing problems", *SIAM Journal* 10, 1962). Above that by the local search
that also orders the cells of a survey.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from companion.core.geo import Point
from mission_tools.errors import NoRoute, NoRouteError, UsageError
from mission_tools.maps.chart import Chart
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.task_route import Stop, TaskLeg, TaskRoute, Transits, joined


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
    measured along the true routes; otherwise as given. is_return: back to the start at the end. Raises
    UsageError: no stops. NoRouteError: the start is no place for a boat, or a stop cannot be reached; names
    every such stop.
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
    is_one_reason = len({str(error) for error in failures}) == 1  # for all stops, such as a start ashore
    if len(failures) == 1 or (is_one_reason and len(failures) == len(stops)):
        raise failures[0]
    if failures:
        named = "; ".join(
            f"{stop_name(stops, number)}: {error}"
            for number, error in zip(unreachable, failures, strict=True)
        )
        raise NoRoute(f"{len(failures)} of {len(stops)} stops cannot be reached: {named}")


EXACT_STOPS = 12

Matrix = NDArray[np.float64]


def best_order(lengths_m: Sequence[Sequence[float]] | Matrix, *, is_return: bool = False) -> tuple[int, ...]:
    """The order of the places 1 … n that makes the route from place 0 through all of them shortest.

    lengths_m[i][j]: length of the way between i and j, finite. is_return: the way back to 0 counts as well.
    """
    matrix = np.asarray(lengths_m, dtype=np.float64)
    if len(matrix) <= 2:
        return tuple(range(1, len(matrix)))
    if len(matrix) - 1 <= EXACT_STOPS:
        return _exact(matrix, is_return=is_return)
    from mission_tools.tasks.survey.sequence import Mode, best_sequence  # noqa: PLC0415 (for long tours only)

    home_m = matrix[0] if is_return else np.zeros(len(matrix))
    with_end = np.block([[matrix, home_m[:, None]], [home_m, 0.0]])
    items = [[Mode(place, place, 0.0)] * 2 for place in range(1, len(matrix))]
    return tuple(item + 1 for item, _ in best_sequence(items, with_end, 0, len(matrix)))


def _exact(matrix: Matrix, *, is_return: bool) -> tuple[int, ...]:
    """best[visited, last]: shortest way from 0 through the set `visited` that ends at `last`."""
    count = len(matrix) - 1
    between = matrix[1:, 1:]
    best = np.full((1 << count, count), math.inf)
    before = np.zeros((1 << count, count), dtype=np.int64)
    for last in range(count):
        best[1 << last, last] = matrix[0, last + 1]
    for visited in range(1, 1 << count):
        absent = [last for last in range(count) if not visited >> last & 1]
        through = best[visited][:, None] + between[:, absent]
        nearest = np.argmin(through, axis=0)
        for column, last in enumerate(absent):
            best[visited | 1 << last, last] = through[nearest[column], column]
            before[visited | 1 << last, last] = nearest[column]
    visited = (1 << count) - 1
    ends = best[visited] + (matrix[1:, 0] if is_return else 0.0)
    last = int(np.argmin(ends))
    order = []
    while visited:
        order.append(last + 1)
        visited, last = visited ^ 1 << last, int(before[visited, last])
    return tuple(reversed(order))
