"""Fences laid in FRAME, for tests without a boat: areas by places in metres, north and east."""

from collections.abc import Sequence

from boat_rig import FRAME, place
from fence_rig import L_CORNERS, Corner, box

from companion.config.tuning import FenceSetting
from companion.core.geo import LatLon
from companion.geofence.fence import Fence, FenceArea, FenceCircle, FencePolygon


def area(corners: Sequence[Corner], is_inclusion: bool = True) -> FencePolygon:
    """A polygon by its corners."""
    return FencePolygon(tuple(place(*corner) for corner in corners), is_inclusion)


def square(half_m: float, is_inclusion: bool = True, north_m: float = 0.0) -> FencePolygon:
    """By half of its side, on the meridian of the origin."""
    return area(box(north_m - half_m, -half_m, north_m + half_m, half_m), is_inclusion)


def circle(north_m: float, east_m: float, radius_m: float, is_inclusion: bool = False) -> FenceCircle:
    """An islet, or the water in a circle."""
    return FenceCircle(place(north_m, east_m), radius_m, is_inclusion)


def laid(*areas: FenceArea, setting: FenceSetting | None = None, home: LatLon | None = None) -> Fence:
    """A fence of these areas."""
    fence = Fence()
    fence.set_areas(areas)
    fence.update(FRAME, home, setting or FenceSetting())
    return fence


L_WATER = area(L_CORNERS)
