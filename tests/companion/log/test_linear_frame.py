"""The log's fast way from local metres to degrees is the exact one's, on both sides of the antimeridian."""

import pytest

from companion.core.geo import LatLon, LocalFrame, Point
from companion.log.linear_frame import LinearFrame

NEAREST_E7 = 2  # 2 cm


@pytest.mark.parametrize("lon_deg", [-1.2, 179.9999, -179.9999, 180.0])
@pytest.mark.parametrize("here", [Point(0.0, 0.0), Point(10.0, 20.0), Point(-10.0, -20.0)])
def test_places_are_those_of_the_frame(lon_deg: float, here: Point) -> None:
    frame = LocalFrame(LatLon(-17.0, lon_deg))
    linear = LinearFrame(frame, here)
    for north_m, east_m in ((0.0, 0.0), (30.0, 30.0), (-30.0, 15.0), (5.0, -25.0)):
        place = frame.to_global(Point(north_m, east_m))
        lat_e7, lon_e7 = linear.to_e7(north_m, east_m)
        assert abs(lat_e7 - place.lat_deg * 1e7) < NEAREST_E7
        assert abs(lon_e7) <= 1_800_000_000
        around = abs(lon_e7 - place.lon_deg * 1e7)
        assert min(around, 3_600_000_000 - around) < NEAREST_E7
