"""GUIDED: another program steers, by a position to sail to or by set-points."""

import math

from companion.core.geo import LatLon
from companion.core.intent import Intent
from companion.core.requests import SetPoint
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.vehicle.modes.controller import ModeController, ModeInputs
from companion.vehicle.modes.station import Station, nearest_inside
from companion.vehicle.passage import Passage
from companion.vehicle.surroundings import Surroundings


class GuidedMode(ModeController):
    """Holds a set-point while it is fresh, sails to the target, or keeps station. AUTO uses it, too.

    The way to the target leads round the fence's lines and what was seen on this voyage.

    target: the position to sail to, None once it is reached. set_point: the one held, None without one.
    """

    def __init__(self, surroundings: Surroundings, status_texts: list[StatusText]) -> None:
        self.target: LatLon | None = None
        self.set_point: SetPoint | None = None
        self._fence = surroundings.fence
        self._passage = Passage(surroundings)
        self._status_texts = status_texts
        self._station = Station()
        self._set_point_s = -math.inf

    def enter(self, inputs: ModeInputs | None) -> None:
        """Keep station here, or at the nearest water inside the fence, until something is asked."""
        self.exit()
        self._station.set(nearest_inside(inputs, self._fence))

    def exit(self) -> None:
        self.set_point = self.target = None
        self._passage.restart()

    def go_to(self, position: LatLon) -> None:
        """Sail there from wherever the boat is."""
        self.set_point, self.target = None, position
        self._passage.aim_anew()

    def hold(self, set_point: SetPoint, now_s: float) -> None:
        """Hold this until it goes stale."""
        self.set_point, self._set_point_s = set_point, now_s

    @property
    def destination(self) -> LatLon | None:
        """The target, else the station."""
        return self.target or self._station.position

    def way_left_m(self, nav: NavState) -> float | None:
        """To the target, round what is in the way."""
        return None if self.target is None else self._passage.left_m(nav.point)

    def intent(self, inputs: ModeInputs) -> Intent:
        """The set-point while it is fresh, else the leg to the target, else the station."""
        if self.set_point is not None:
            if inputs.now_s - self._set_point_s <= inputs.config.modes.set_point_timeout_s:
                return self.set_point.hold
            self.set_point = self.target = None
            self._station.set(inputs.position)
            text = "GUIDED: set-point is stale, keeping station"
            self._status_texts.append(StatusText(Severity.WARNING, text))
        if self.target is not None:
            leg = self._passage.leg(
                inputs.nav, [inputs.frame.to_local(self.target)], inputs.config, inputs.now_s
            )
            if leg is not None:
                return leg.intent(inputs.speed_m_s)
            self._station.set(self.target)
            self.target = None
            self._status_texts.append(StatusText(Severity.INFO, "GUIDED: arrived"))
        return self._station.intent(inputs)
