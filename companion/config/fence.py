"""Configuration of the fence."""

from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section

CIRCLE_KIND = 2  # of `kinds`: the circle around home
AREAS_KIND = 4  # of `kinds`: the uploaded areas


class FenceSetting(Section, frozen=True):
    """kinds is ArduPilot's FENCE_TYPE: the sum of 2 for the circle of radius_m around home and 4 for the
    uploaded polygons and circles. `failsafe.fence_action` is the action on a breach.
    """

    enabled: bool = True
    kinds: Annotated[int, Meta(ge=0, le=7)] = AREAS_KIND
    radius_m: Positive = 300.0
    margin_m: NonNegative = 2.0  # the boat stops this far inside; its way home keeps half as much again
    rally_includes_home: bool = True  # RTL may also go home if there are rally points
