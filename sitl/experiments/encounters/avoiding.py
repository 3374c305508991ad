"""How calmly the boat avoids: travel of its motors meanwhile, and changes of the side that it reports."""

from collections.abc import Sequence
from itertools import pairwise

from companion.boat import TICK_S
from companion.obstacles.planning.planner import PASSING, Stage
from sitl.run.mission_run import MissionRun


class AvoidingRun(MissionRun):
    """avoiding_s: time under way while the local planner steers. travels: full scales of each motor in it."""

    avoiding_s = 0.0
    travels = (0.0, 0.0)
    _commands = (0.0, 0.0)

    def _step(self) -> None:
        super()._step()
        boat, truth = self.lockstep.boat, self.lockstep.world.truth
        before, self._commands = self._commands, (truth.left_command, truth.right_command)
        if boat.vehicle.armed and boat.guidance.avoidance.stage is not Stage.CLEAR:
            self.avoiding_s += TICK_S
            left, right = (abs(now - then) for now, then in zip(self._commands, before, strict=True))
            self.travels = self.travels[0] + left, self.travels[1] + right


def side_changes(texts: Sequence[str]) -> int:
    """How often the reported side differs from the one before."""
    sides = [text for text in texts if text.startswith(PASSING)]
    return sum(one != other for one, other in pairwise(sides))
