"""What a plan is asked to be, and what comes of it."""

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args

from companion.core.geo import Point
from mission_tools.errors import UsageError
from mission_tools.maps.source import RouteDefaults

HeuristicName = Literal["octile", "euclidean", "manhattan"]
HEURISTICS: tuple[HeuristicName, ...] = get_args(HeuristicName)


@dataclass(frozen=True, slots=True)
class PlanSettings:
    """What a plan is asked to be.

    clearance_m: distance kept from shores, obstacles and keep-out areas. margin_m: planned on top of it where
    there is room, for what the boat will sail beside the plan: its corners and its receiver's wander. Routes
    are exact, among the polygons, unless a grid is asked for by one of these: cell_m: side of a cell;
    heuristic: its name; smooth: False for the path from cell to cell. Raises UsageError: a value that makes
    no sense.
    """

    clearance_m: float = 4.0
    cell_m: float | None = None
    heuristic: HeuristicName | None = None
    smooth: bool = True
    margin_m: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.clearance_m < math.inf:
            raise UsageError(f"clearance is {self.clearance_m} m: expected 0 or more")
        if not 0.0 <= self.margin_m < math.inf:
            raise UsageError(f"margin is {self.margin_m} m: expected 0 or more")
        if self.cell_m is not None and not 0.0 < self.cell_m < math.inf:
            raise UsageError(f"cell size is {self.cell_m} m: expected more than 0")
        if self.heuristic is not None and self.heuristic not in HEURISTICS:
            raise UsageError(f"heuristic {self.heuristic!r} is none of {', '.join(HEURISTICS)}")

    @classmethod
    def from_route(cls, route: RouteDefaults, **given: object) -> "PlanSettings":
        """What was given on the command line (None: nothing), else what the scenario says, else the default.
        Raises UsageError: a value that makes no sense.
        """
        names = ("clearance_m", "margin_m", "cell_m", "heuristic", "smooth")
        named: dict[str, Any] = {name: getattr(route, name) for name in names}
        named |= {name: value for name, value in given.items() if value is not None}
        return cls(**{name: value for name, value in named.items() if value is not None})

    @property
    def is_grid(self) -> bool:
        """Whether the route is searched on a grid."""
        return not (self.cell_m is None and self.heuristic is None and self.smooth)

    @property
    def required_m(self) -> float:
        """What a route keeps from shores: clearance and margin."""
        return self.clearance_m + self.margin_m


@dataclass(frozen=True, slots=True)
class Plan:
    """A route, start and goal included.

    found: what the search found, the shortest route or a path from cell to cell. points: the same with
    few long legs, and room at its corners for the boat's turns. straight_m: from point to point through
    the vias as the crow flies. min_clearance_m: along the whole route but the way out of a start nearer
    to a shore than the clearance; infinite in open water. cell_m: the cell used; None for an exact route.
    expanded: cells, or tangents, by the search. notes: what a person should know.
    """

    points: tuple[Point, ...]
    found: tuple[Point, ...]
    length_m: float
    straight_m: float
    min_clearance_m: float
    cell_m: float | None
    expanded: int
    settings: PlanSettings
    notes: tuple[str, ...] = ()
