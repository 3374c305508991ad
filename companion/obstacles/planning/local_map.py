"""The grid around the boat, and the way that is left to the goal in it. Both are kept for a while."""

import math
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.state import NavState
from companion.obstacles.perception.occupancy import SWEEP_S
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.planning.clearance import ClearanceBounds, ClearanceField
from companion.obstacles.planning.cost import HULL, TOUCH
from companion.obstacles.planning.cost_to_go import CostToGo
from companion.obstacles.planning.detour import Detour

_MOVES: Final = 0.2  # of the grid's reach: the boat's way off the centre after which it is laid anew
_FENCE_STEP_M: Final = 0.5  # of the margin that is left
_SEARCH_S: Final = 0.5  # between two computations of the way to go: the boat moves half a hull


class LocalMap:
    """Nearer to the fence than its margin, the boat keeps what is left."""

    def __init__(self) -> None:
        self._field: ClearanceField | None = None
        self._key: tuple[object, ...] | None = None
        self.forget()

    def forget(self) -> None:
        """There is another goal."""
        self._to_go: CostToGo | None = None
        self._searched_s = self._open_s = -math.inf

    def search_anew(self) -> None:
        """Something has changed on the way to the goal."""
        self._to_go = None

    def update(
        self,
        nav: NavState,
        config: BoatConfig,
        perception: ObstaclePerception,
        bounds: ClearanceBounds,
        margin_m: float,
        reach_m: float,
        now_s: float,
    ) -> ClearanceField:
        """The grid with the fence and all that is known now. margin_m: to keep from obstacles."""
        field, here, fence_m, cell_m = self._field, nav.point, -1.0, perception.occupancy.cell_m
        if bounds.is_active and bounds.is_near(here, 2.0 * reach_m):
            least_m = config.fence.margin_m
            room_m = bounds.margin_within_m(*here, least_m + cell_m)
            fence_m = least_m if room_m > least_m else _FENCE_STEP_M * math.floor(room_m / _FENCE_STEP_M)
        key = (bounds.version, cell_m, reach_m, fence_m)
        if field is None or distance_m(field.centre, here) > _MOVES * reach_m or key != self._key:
            field = self._field = ClearanceField(here, cell_m, reach_m)
            self._key, self._to_go = key, None
            if fence_m >= 0.0:
                field.fence(bounds, fence_m)
        suspects = perception.suspects()
        if suspects and perception.water.is_used and now_s >= self._searched_s + _SEARCH_S:
            field.look(perception.water.are_known)
        field.fill(perception.solid(), suspects, TOUCH * margin_m)
        return field

    def way_to(
        self,
        field: ClearanceField,
        here: Point,
        goal: Point,
        margin_m: float,
        detour: Detour,
        now_s: float,
        *,
        is_certain: bool,
    ) -> CostToGo:
        """What is left to the goal in the grid, from time to time anew. is_certain: not for single echoes."""
        to_go = self._to_go
        if to_go is None or now_s >= self._searched_s + _SEARCH_S:
            shuts = detour.shuts if detour.side else None
            to_go = self._to_go = CostToGo(field, here, goal, margin_m, HULL * margin_m, shuts)
            is_first = now_s > self._searched_s + SWEEP_S  # in open water nobody searches
            if to_go.is_open or not is_certain or is_first:
                self._open_s = now_s
            self._searched_s = now_s
        return to_go

    def is_shut(self, now_s: float) -> bool:
        """Whether no way was open for a full sweep."""
        return now_s > self._open_s + SWEEP_S
