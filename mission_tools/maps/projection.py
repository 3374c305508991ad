"""WGS 84 positions to a local frame with PROJ: the same frame as `companion.core.geo.LocalFrame`."""

import numpy as np
import pyproj
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon


def _transverse_mercator(origin: LatLon) -> pyproj.Transformer:
    return pyproj.Transformer.from_pipeline(
        "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad "
        f"+step +proj=tmerc +lat_0={origin.lat_deg!r} +lon_0={origin.lon_deg!r} +k=1 +ellps=WGS84"
    )


def to_local(geometry: BaseGeometry, origin: LatLon) -> BaseGeometry:
    """Project a geometry of (longitude, latitude) degrees to (east, north) metres around the origin."""
    projection = _transverse_mercator(origin)

    def project(lon_lat: NDArray[np.float64]) -> NDArray[np.float64]:
        east, north = projection.transform(lon_lat[:, 0], lon_lat[:, 1], errcheck=True)
        return np.column_stack((east, north))

    projected: BaseGeometry = shapely.transform(geometry, project)
    return projected
