"""RTL: home, or to the nearest rally point, inside the fence."""

import math

from companion.core.geo import LatLon, LocalFrame
from companion.core.intent import Intent
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.estimation.estimator import MAX_OFFSET_M
from companion.vehicle.modes.controller import ModeController, ModeInputs
from companion.vehicle.return_route import ReturnRoute


class RtlMode(ModeController):
    """Follows the return route, then keeps station at its end."""

    def __init__(self, route: ReturnRoute, status_texts: list[StatusText]) -> None:
        self._route = route
        self._status_texts = status_texts

    def fault(self, inputs: ModeInputs) -> str:
        """Without rally points, RTL needs a home within reach."""
        if self._route.rally:
            return ""
        if inputs.home is None:
            return "no home"
        fault = home_fault(inputs.home, inputs.frame)
        return f"home is {fault}" if fault else ""

    def enter(self, inputs: ModeInputs | None) -> None:  # noqa: ARG002
        """Start from wherever the boat is."""
        self._route.restart()

    def intent(self, inputs: ModeInputs) -> Intent:
        had_arrived = self._route.has_arrived
        speed_m_s = inputs.config.mission.rtl_speed_m_s or inputs.speed_m_s
        intent = self._route.update(inputs.nav, inputs.config, speed_m_s, inputs.now_s)
        if self._route.has_arrived and not had_arrived:
            self._status_texts.append(StatusText(Severity.INFO, "RTL: arrived"))
        return intent

    def way_left_m(self, nav: NavState) -> float | None:
        return self._route.way_left_m(nav.point)

    @property
    def destination(self) -> LatLon | None:
        return self._route.target


def home_fault(home: LatLon, frame: LocalFrame | None) -> str:
    """Why a position cannot be home from where the boat is; empty when it can, or that is not known yet."""
    if frame is None or math.hypot(*frame.to_local(home)) <= MAX_OFFSET_M:
        return ""
    return f"more than {MAX_OFFSET_M / 1e3:.0f} km away"
