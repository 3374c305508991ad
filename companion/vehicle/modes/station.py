"""A place to keep station at, for the modes that stay."""

from companion.core.geo import LatLon
from companion.core.intent import KeepStation
from companion.geofence.fence import Fence
from companion.vehicle.modes.controller import ModeInputs


class Station:
    """position: None until the first `intent` after `set(None)`, which takes the boat's own."""

    def __init__(self) -> None:
        self.position: LatLon | None = None
        self._intent: KeepStation | None = None

    def set(self, position: LatLon | None) -> None:
        """Move the station; None: to where the boat is at the next tick."""
        self.position, self._intent = position, None

    def intent(self, inputs: ModeInputs) -> KeepStation:
        if self.position is None:
            self.position = inputs.position
        if self._intent is None:
            self._intent = KeepStation(inputs.frame.to_local(self.position))
        return self._intent


def nearest_inside(inputs: ModeInputs | None, fence: Fence) -> LatLon | None:
    """The boat's position, or the nearest water well inside the fence; None while it is unknown."""
    if inputs is None:
        return None
    margin_m = inputs.config.fence.margin_m
    if fence.margin_m(inputs.nav.point) >= margin_m:
        return inputs.position
    inside = fence.inside(inputs.nav.point, margin_m + inputs.config.guidance.station_radius_m)
    return inputs.frame.to_global(inside)
