"""Every mode's controller. A new mode is a file here, a row in `core/modes.py`, and an entry below."""

from companion.core.modes import Mode
from companion.core.status_text import StatusText
from companion.rc.manual_input import ManualInput
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.modes.auto import AutoMode
from companion.vehicle.modes.by_hand import AcroMode, HoldMode, ManualMode, SimpleMode, SteeringMode
from companion.vehicle.modes.circle import CircleMode
from companion.vehicle.modes.controller import ModeController
from companion.vehicle.modes.follow import FollowMode
from companion.vehicle.modes.guided import GuidedMode
from companion.vehicle.modes.loiter import LoiterMode
from companion.vehicle.modes.rtl import RtlMode
from companion.vehicle.modes.smart_rtl import SmartRtlMode
from companion.vehicle.return_route import ReturnRoute
from companion.vehicle.surroundings import Surroundings
from companion.vehicle.track import SailedTrack


class ModeRegistry:
    """controllers: by mode. By name: those that the vehicle also asks or tells something of its own."""

    def __init__(
        self,
        surroundings: Surroundings,
        route: ReturnRoute,
        progress: MissionProgress,
        track: SailedTrack,
        sticks: ManualInput,
        status_texts: list[StatusText],
    ) -> None:
        """status_texts: where messages to the operator are appended."""
        fence = surroundings.fence
        self.manual = ManualMode(sticks)
        self.loiter = LoiterMode(fence)
        self.guided = GuidedMode(surroundings, status_texts)
        self.follow = FollowMode(status_texts)
        self.rtl = RtlMode(route, status_texts)
        self.auto = AutoMode(progress, self.guided, surroundings, status_texts)
        self.controllers: dict[Mode, ModeController] = {
            Mode.MANUAL: self.manual,
            Mode.ACRO: AcroMode(sticks),
            Mode.STEERING: SteeringMode(sticks),
            Mode.HOLD: HoldMode(),
            Mode.LOITER: self.loiter,
            Mode.FOLLOW: self.follow,
            Mode.SIMPLE: SimpleMode(sticks),
            Mode.CIRCLE: CircleMode(),
            Mode.AUTO: self.auto,
            Mode.RTL: self.rtl,
            Mode.SMART_RTL: SmartRtlMode(track, surroundings, status_texts),
            Mode.GUIDED: self.guided,
        }
