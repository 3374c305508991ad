"""Configuration of the fence: what holds the boat in, and what happens at its lines."""

from typing import Annotated

from msgspec import Meta

from companion.section import NonNegative, Positive, Section

CIRCLE_KIND = 2  # of `kinds`: the circle round home
AREAS_KIND = 4  # of `kinds`: the uploaded areas


class FenceSetting(Section, frozen=True):
    """The numbers of kinds and action are ArduPilot Rover's.

    kinds adds up 2 for the circle of radius_m round home and 4 for the uploaded polygons and circles. action
    is what a breach does: 0 it is only told, 1 RTL, 2 HOLD, 3 SMART_RTL or RTL, 4 SMART_RTL or HOLD. Such a
    HOLD is a station on the nearest water inside.
    """

    enabled: bool = True
    kinds: Annotated[int, Meta(ge=0, le=7)] = AREAS_KIND
    radius_m: Positive = 300.0
    margin_m: NonNegative = 2.0  # the boat stops so far inside, and its way home keeps half as much again
    action: Annotated[int, Meta(ge=0, le=4)] = 1
    rally_includes_home: bool = True  # RTL may also go to home where there are rally points
