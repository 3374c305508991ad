"""A survey with every kind of wrong sounding and a hole in it, charted once for several tests."""

from functools import cache

import numpy as np
import pyproj
from sounded_lake import DEGREE_M, ORIGIN, bowl, lake, soundings, with_values

from mission_tools.bathymetry.depth_chart import ChartSettings, DepthChart, charted
from mission_tools.bathymetry.soundings import Soundings

LAKE = lake()
BOTTOM = bowl(LAKE, 41)
HOLE = (-30.0, 10.0)  # east, north: nothing within 11 m of it


def survey() -> Soundings:
    """Lines 8 m apart: dropouts, second echoes, weeds, a jump, and the hole."""
    s = soundings(LAKE, BOTTOM, 41, spacing_m=8.0)
    s = with_values(s, slice(0, None, 40), depth_m=np.nan)
    s = with_values(s, slice(1003, 1013), depth_m=2.0 * s.depth_m[1003:1013])
    s = with_values(s, slice(2003, 2013), depth_m=0.5 * s.depth_m[2003:2013], quality=0.2)
    s = with_values(s, slice(4003, 4013), lat_deg=s.lat_deg[4003:4013] + 12.0 / DEGREE_M)
    crs = f"+proj=aeqd +lat_0={ORIGIN.lat_deg} +lon_0={ORIGIN.lon_deg} +ellps=WGS84"
    east, north = pyproj.Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(
        s.lon_deg, s.lat_deg
    )
    near = np.hypot(east - HOLE[0], north - HOLE[1]) < 11.0
    return with_values(s, np.nonzero(near)[0], depth_m=np.nan)


@cache
def charted_lake() -> DepthChart:
    """The chart of that survey, as it comes without options."""
    return charted(LAKE, survey(), ChartSettings())
