"""Configuration of the fence: what holds the boat in, and what happens at its lines."""

from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section

CIRCLE_KIND = 2  # of `kinds`: the circle round home
AREAS_KIND = 4  # of `kinds`: the uploaded areas


class FenceSetting(Section, frozen=True):
    """kinds is ArduPilot's FENCE_TYPE: the sum of 2 for the circle of radius_m round home and 4 for the
    uploaded polygons and circles. What a breach does is `failsafe.fence_action`.
    """

    enabled: bool = True
    kinds: Annotated[int, Meta(ge=0, le=7)] = AREAS_KIND
    radius_m: Positive = 300.0
    margin_m: NonNegative = 2.0  # the boat stops so far inside, and its way home keeps half as much again
    rally_includes_home: bool = True  # RTL may also go to home where there are rally points
