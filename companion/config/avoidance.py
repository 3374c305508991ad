"""What the boat does about things in its way that its rangers see."""

import math
from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section


class AvoidanceSetting(Section, frozen=True):
    """Looking out, and keeping clear. Distances are from the boat's centre.

    enable: Rover's AVOID_ENABLE, a sum of 1 fence, 2 what the rangers see; goes_round: Rover's OA_TYPE, 0
    stops before things, 1 goes round them. by_sight: when not to sail faster than the boat can stop in the
    water that it has looked at: 0 never, 1 always, which is what sailing off the map wants, 2 for a while
    after something was in the way that the plan did not know of.
    """

    enable: Annotated[int, Meta(ge=0, le=7)] = 3
    goes_round: bool = True
    by_sight: Annotated[int, Meta(ge=0, le=2)] = 2
    by_hand: bool = False  # stop before things in the modes steered by hand too
    margin_m: Positive = 1.0  # from the edge of things
    lookahead_m: Positive = 6.0  # things farther off are left alone
    beam_rad: Annotated[float, Meta(gt=0.0, le=math.pi)] = math.radians(15.0)  # of the boat's own ranger
    memory_s: Positive = 25.0  # what was seen often is believed for so long out of sight
    detour_m: NonNegative = 80.0  # a longer way round is given up
    retry_s: Positive = 30.0  # until the next try after that

    @property
    def avoids_obstacles(self) -> bool:
        """Whether anything is done about what the rangers see."""
        return bool(self.enable & 2)
