"""The bottom of the water: depths and weed on a grid, bilinear in between.

Away from a shore the depth rises as D (1 − exp(−s c / D)) with the clearance c: by the slope s at the shore,
to the even depth D in the middle. Bumps, a stream's bed and roughness are added to D. The roughness is a
self-affine surface: its spectral density falls as k^(−2 H − 2) with the wave number k, H being the Hurst
exponent (D. L. Turcotte, *Fractals and Chaos in Geology and Geophysics*, 2nd edition, 1997, chapter 7).
"""

import math
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from companion.cli.program_end import how_to_install
from companion.core.errors import ConfigError
from mission_tools.maps.chart import Chart
from sitl.world.environment.settings import Bottom, Environment

Floats = NDArray[np.float64]

_MOST_CELLS: Final = 1_000_000  # of a larger map they are wider
_OPEN_BOUNDS_M: Final = (-500.0, -500.0, 500.0, 500.0)  # without a shore; beyond, it is as at the edge
_WEED_SHARE_OF_DEPTH: Final = 0.6  # a canopy ends below the surface


class Bathymetry:
    """Depth of a chart's water after the scenario's settings; 0 at its shores and ashore.

    Raises ConfigError: a GeoTIFF that cannot be read; names the file.
    """

    def __init__(self, chart: Chart, environment: Environment) -> None:
        bottom, bounds_m = environment.bottom, _OPEN_BOUNDS_M if chart.is_open else chart.water.bounds
        self._west_m, self._south_m, east_m, north_m = map(float, bounds_m)
        area_m2 = (east_m - self._west_m) * (north_m - self._south_m)
        self._cell_m = cell_m = max(bottom.cell_m, math.sqrt(area_m2 / _MOST_CELLS))
        east, north = np.meshgrid(
            np.arange(self._west_m, east_m + 2.0 * cell_m, cell_m),
            np.arange(self._south_m, north_m + 2.0 * cell_m, cell_m),
        )
        clearance_m = _clearance_m(chart, north, east, cell_m)
        even_m, rise_m = environment.depth_m, environment.shore_slope * clearance_m
        depth_m = np.minimum(even_m, rise_m)
        if bottom.kind == "geotiff":
            read_m = _of_file(bottom.file, chart, (self._west_m, self._south_m, cell_m), east.shape)
            depth_m = np.where(np.isnan(read_m), depth_m, read_m * (clearance_m > 0.0))
        elif bottom.kind != "slope":
            uneven_m = even_m + _relief_m(bottom, north, east, cell_m)
            depth_m = uneven_m.clip(0.0) * -np.expm1(-rise_m / even_m)
        self._depth_m, self._canopy_m = depth_m, _canopy_m(bottom, depth_m, cell_m)

    def depth_m(self, north_m: float, east_m: float) -> float:
        """Depth at a place."""
        return self._at(self._depth_m, north_m, east_m)

    def canopy_m(self, north_m: float, east_m: float) -> float:
        """Height of the weed above the bottom at a place, 0 without any."""
        return self._at(self._canopy_m, north_m, east_m)

    def depths_m(self, north_m: Floats, east_m: Floats) -> Floats:
        """Depths at places, of any shape."""
        cells = (north_m - self._south_m) / self._cell_m, (east_m - self._west_m) / self._cell_m
        found: Floats = map_coordinates(self._depth_m, cells, order=1, mode="nearest")
        return found

    def _at(self, values: Floats, north_m: float, east_m: float) -> float:
        cell = ((north_m - self._south_m) / self._cell_m,), ((east_m - self._west_m) / self._cell_m,)
        return float(map_coordinates(values, cell, order=1, mode="nearest")[0])


def _clearance_m(chart: Chart, north: Floats, east: Floats, cell_m: float) -> Floats:
    """Distance from the shore, 0 ashore, infinite without a shore."""
    if chart.is_open:
        return np.full_like(east, math.inf)
    shapely.prepare(chart.water)
    clearance_m, is_wet = np.zeros_like(east), shapely.contains_xy(chart.water, east, north)
    shore = shapely.get_coordinates(shapely.segmentize(chart.water.boundary, 0.25 * cell_m))
    clearance_m[is_wet], _ = cKDTree(shore).query(np.column_stack((east[is_wet], north[is_wet])))
    return clearance_m


def _relief_m(bottom: Bottom, north: Floats, east: Floats, cell_m: float) -> Floats:
    """What is added to the even depth."""
    relief_m = np.zeros_like(east)
    for bump in bottom.bumps:
        square_m2 = (east - bump.centre[0]) ** 2 + (north - bump.centre[1]) ** 2
        relief_m += bump.deeper_m * np.exp(-0.5 * square_m2 / bump.radius_m**2)
    if bottom.stream is not None:
        course = shapely.LineString(bottom.stream.through)
        off_m = shapely.distance(course, shapely.points(east, north))
        relief_m += bottom.stream.deeper_m * np.exp(-0.5 * (2.0 * off_m / bottom.stream.width_m) ** 2)
    if bottom.kind == "fractal":
        rough = _noise(east.shape, bottom.hurst, bottom.longest_m / cell_m, bottom.seed)
        relief_m += bottom.roughness_m * rough
    return relief_m


def _canopy_m(bottom: Bottom, depth_m: Floats, cell_m: float) -> Floats:
    """Patches of weed over its share of the water."""
    if not bottom.weed_share:
        return np.zeros_like(depth_m)
    patches, is_wet = _noise(depth_m.shape, 1.0, bottom.weed_patch_m / cell_m, bottom.seed + 1), depth_m > 0.0
    least = np.quantile(patches[is_wet], 1.0 - bottom.weed_share)
    height_m = np.minimum(bottom.weed_height_m, _WEED_SHARE_OF_DEPTH * depth_m)
    return np.where(is_wet & (patches >= least), height_m, 0.0)


def _noise(shape: tuple[int, ...], hurst: float, longest_cells: float, seed: int) -> Floats:
    """A self-affine surface with a mean of 0 and a standard deviation of 1, without longer waves."""
    white = np.fft.rfft2(np.random.default_rng(seed).standard_normal(shape))
    number = np.hypot(np.fft.fftfreq(shape[0])[:, None], np.fft.rfftfreq(shape[1])[None, :])
    share = np.maximum(number, 1e-9) ** -(hurst + 1.0) * (number * longest_cells >= 1.0)
    rough = np.fft.irfft2(white * share, s=shape)
    standard: Floats = (rough - rough.mean()) / max(float(rough.std()), 1e-12)
    return standard


def _of_file(file: str, chart: Chart, grid: tuple[float, float, float], shape: tuple[int, ...]) -> Floats:
    """Depths of a GeoTIFF's first band on a grid (west, south, cell), NaN beyond it. Without a reference
    system its coordinates are east and north in the chart's frame.
    """
    try:
        import rasterio  # noqa: PLC0415 (an extra)
        from rasterio.warp import Resampling, reproject  # noqa: PLC0415
    except ModuleNotFoundError as error:
        raise ConfigError(
            f"{file}: needs the extra 'survey' (no module {error.name!r}): {how_to_install('survey')}"
        ) from None
    origin, (west_m, south_m, cell_m) = chart.frame.origin, grid
    frame = f"+proj=tmerc +lat_0={origin.lat_deg!r} +lon_0={origin.lon_deg!r} +k=1 +ellps=WGS84 +units=m"
    place = rasterio.Affine(cell_m, 0.0, west_m - 0.5 * cell_m, 0.0, cell_m, south_m - 0.5 * cell_m)
    depth_m = np.full(shape, np.nan)
    try:
        with rasterio.open(file) as source:
            reproject(
                rasterio.band(source, 1), depth_m, src_crs=source.crs or frame, dst_crs=frame,
                dst_transform=place, dst_nodata=np.nan, resampling=Resampling.bilinear,
            )  # fmt: skip
    except rasterio.errors.RasterioError as error:
        raise ConfigError(f"{file}: cannot be read as a GeoTIFF of depths: {error}") from None
    if not np.any(depth_m > 0.0):
        raise ConfigError(f"{file}: no depth in this water: expected metres below the surface, positive")
    return depth_m.clip(0.0)
