"""Configuration of obstacle avoidance."""

import math
from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section


class AvoidanceSetting(Section, frozen=True):
    """Obstacle detection and avoidance. Distances are from the boat's centre.

    enable: Rover's AVOID_ENABLE, a sum of 1 fence, 2 rangers; goes_round: Rover's OA_TYPE, 0 stops before
    obstacles, 1 goes around them. by_sight: where the speed is limited to what the boat can stop from within
    the water that its rangers have looked at: 0 nowhere, 1 everywhere, 2 near an obstacle that no plan knew,
    for water that is on the plan's map, 3 there and outside an uploaded inclusion fence.
    """

    enable: Annotated[int, Meta(ge=0, le=7)] = 3
    goes_round: bool = True
    by_sight: Annotated[int, Meta(ge=0, le=3)] = 3
    by_hand: bool = False  # stop before obstacles in manual modes, too
    margin_m: Positive = 1.0  # from the edge of obstacles
    lookahead_m: Positive = 6.0  # obstacles farther off are ignored
    beam_rad: Annotated[float, Meta(gt=0.0, le=math.pi)] = math.radians(15.0)  # of the boat's own ranger
    memory_s: Positive = 120.0  # how long a well-observed obstacle is kept out of sight
    detour_m: NonNegative = 80.0  # longest detour
    retry_s: Positive = 30.0  # until the next attempt

    @property
    def avoids_obstacles(self) -> bool:
        """Whether the rangers are used."""
        return bool(self.enable & 2)
