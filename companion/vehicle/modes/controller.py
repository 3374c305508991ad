"""The interface of a mode, and what a mode decides from."""

from abc import ABC, abstractmethod
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, LocalFrame
from companion.core.intent import Intent
from companion.core.state import NavState


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

    def way_left_m(self, nav: NavState) -> float | None:  # noqa: ARG002
        """Length of the way to the destination; None where it is straight, or not known."""
        return None

    @property
    def destination(self) -> LatLon | None:
        """The current waypoint, target or station, for telemetry; None without one."""
        return None
