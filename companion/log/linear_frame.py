"""Fast conversion of local metres to 1e7 degrees."""

from companion.core.geo import LocalFrame, Point, longitude_difference_deg

_REACH_M = 50.0  # the linearisation error is 0.2 mm at 50 m and 50° of latitude; 1e-7 degrees are 11 mm
_STEP_M = 50.0
_HALF_TURN_E7 = 1_800_000_000


class LinearFrame:
    """A LocalFrame linearised around a place near the boat, which moves with it."""

    def __init__(self, frame: LocalFrame, here: Point) -> None:
        self._frame = frame
        self._set_origin(here)

    def is_of(self, frame: LocalFrame) -> bool:
        """Whether it belongs to this frame."""
        return self._frame is frame

    def to_e7(self, north_m: float, east_m: float) -> tuple[int, int]:
        """Latitude and longitude in 1e-7 degrees."""
        anchor = self._anchor
        north, east = north_m - anchor.north_m, east_m - anchor.east_m
        if not (-_REACH_M < north < _REACH_M and -_REACH_M < east < _REACH_M):
            self._set_origin(Point(north_m, east_m))
            north = east = 0.0
        lat, lon = self._lat_per_m, self._lon_per_m
        lon_e7 = round(self._lon_e7 + north * lon[0] + east * lon[1])
        if not -_HALF_TURN_E7 <= lon_e7 <= _HALF_TURN_E7:
            lon_e7 -= 2 * _HALF_TURN_E7 if lon_e7 > 0 else -2 * _HALF_TURN_E7
        return round(self._lat_e7 + north * lat[0] + east * lat[1]), lon_e7

    def _set_origin(self, here: Point) -> None:
        """Slopes from places to both sides, so that they are those of the middle."""
        to_global, (north_m, east_m) = self._frame.to_global, here
        self._anchor = here
        middle = to_global(here)
        self._lat_e7, self._lon_e7 = middle.lat_deg * 1e7, middle.lon_deg * 1e7
        north, south = (
            to_global(Point(north_m + _STEP_M, east_m)),
            to_global(Point(north_m - _STEP_M, east_m)),
        )
        east, west = to_global(Point(north_m, east_m + _STEP_M)), to_global(Point(north_m, east_m - _STEP_M))
        scale = 1e7 / (2.0 * _STEP_M)
        self._lat_per_m = (north.lat_deg - south.lat_deg) * scale, (east.lat_deg - west.lat_deg) * scale
        self._lon_per_m = (
            longitude_difference_deg(north.lon_deg, south.lon_deg) * scale,
            longitude_difference_deg(east.lon_deg, west.lon_deg) * scale,
        )
