"""AUTO: the mission, item by item. Within a GUIDED item another program steers, as in GUIDED."""

from companion.core.geo import LatLon, LocalFrame
from companion.core.intent import Intent
from companion.core.state import NavState
from companion.core.status_text import StatusText
from companion.vehicle.mission.check import MissionCheck
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.mission.route_to_mission import RouteToMission
from companion.vehicle.mission.steps import GoRound, Waypoint
from companion.vehicle.modes.controller import ModeController, ModeInputs
from companion.vehicle.modes.guided import GuidedMode
from companion.vehicle.surroundings import Surroundings


class AutoMode(ModeController):
    """Sails the mission on from its current item."""

    def __init__(
        self,
        progress: MissionProgress,
        guided: GuidedMode,
        surroundings: Surroundings,
        status_texts: list[StatusText],
    ) -> None:
        self._progress = progress
        self._guided = guided
        self._guided_seq = -1  # the item in which another program steers
        self._fence = surroundings.fence
        self._check = MissionCheck(status_texts)
        self._route_to_mission = RouteToMission(surroundings, status_texts)

    def prepare(self, frame: LocalFrame) -> None:
        """Check some more items against the fence. To be called every tick."""
        self._check.advance(self._progress.mission, self._fence, frame)

    def fault(self, inputs: ModeInputs) -> str:  # noqa: ARG002
        """There must be a mission, inside the fence."""
        return "no mission" if self._progress.is_empty else self._check.fault

    def enter(self, inputs: ModeInputs | None) -> None:  # noqa: ARG002
        """Continue with the current item; from the first if the mission is complete."""
        self.exit()
        if self._progress.finished:
            self._progress.restart()
        self._progress.resume()

    def exit(self) -> None:
        """Drop the other program's target and set-point."""
        self._guided_seq = -1
        self._guided.exit()

    def intent(self, inputs: ModeInputs) -> Intent:
        """The current item's leg, by the water where it is not clear."""
        progress = self._progress
        intent = progress.update(inputs.nav, inputs.frame, inputs.config, inputs.now_s)
        if not progress.is_handed_over:
            self._guided_seq = -1
            return self._route_to_mission.update(intent, progress, inputs.nav, inputs.config, inputs.now_s)
        if self._guided_seq != progress.current_seq:
            self._guided_seq = progress.current_seq
            self._guided.enter(inputs)
        return self._guided.intent(inputs)

    def way_left_m(self, nav: NavState) -> float | None:
        """To the end of the leg, round what is in the way."""
        return self._route_to_mission.left_m(nav.point)

    @property
    def destination(self) -> LatLon | None:
        progress = self._progress
        if progress.current_seq >= len(progress.mission):
            return None
        step = progress.mission[progress.current_seq]
        if isinstance(step, Waypoint | GoRound) and isinstance(step.position, LatLon):
            return step.position
        return None
