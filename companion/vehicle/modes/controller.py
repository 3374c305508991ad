"""The interface of a mode, and what a mode decides from."""

from abc import ABC, abstractmethod
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, LocalFrame
from companion.core.intent import Intent, Stop
from companion.core.state import NavState
from companion.rc.manual_input import ManualInput

_STOP = Stop()


class ModeInputs(NamedTuple):
    """One tick's inputs. speed_m_s: set by the operator, else cruise speed."""

    nav: NavState
    frame: LocalFrame
    config: BoatConfig
    home: LatLon | None
    speed_m_s: float
    now_s: float

    @property
    def position(self) -> LatLon:
        """The boat's position on the globe."""
        return self.frame.to_global(self.nav.point)


class ModeController(ABC):
    """One mode. The vehicle calls `enter` when the mode begins or the boat is armed in it."""

    def fault(self, inputs: ModeInputs) -> str:  # noqa: ARG002
        """Why the mode cannot be entered now, for the operator; empty when it can."""
        return ""

    def enter(self, inputs: ModeInputs | None) -> None:  # noqa: B027
        """Begin. inputs: None while the position is unknown."""

    def exit(self) -> None:  # noqa: B027
        """End: another mode begins."""

    @abstractmethod
    def intent(self, inputs: ModeInputs) -> Intent:
        """What guidance is to do now."""

    @property
    def destination(self) -> LatLon | None:
        """The current waypoint, target or station, for telemetry; None without one."""
        return None


class StickMode(ModeController):
    """A mode that the operator steers by hand, with an estimate. No thrust while the sticks are stale."""

    def __init__(self, sticks: ManualInput) -> None:
        self._sticks = sticks

    def intent(self, inputs: ModeInputs) -> Intent:
        """What the sticks ask for."""
        config, now_s = inputs.config, inputs.now_s
        if not self._sticks.is_fresh(config, now_s):
            return _STOP
        throttle, steering = self._sticks.throttle_and_steering(config, now_s)
        return self.steer(throttle, steering, inputs)

    @abstractmethod
    def steer(self, throttle: float, steering: float, inputs: ModeInputs) -> Intent:
        """The intent for fresh sticks, each in [-1, 1]; steering positive to starboard."""
