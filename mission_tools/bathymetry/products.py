"""The files of a chart, by GDAL: vectors and text in WGS 84, the grid in the chart's frame."""

import json
from pathlib import Path
from typing import Any, Final

import contourpy
import numpy as np
import pyogrio
import pyproj
import rasterio
import shapely
from numpy.typing import NDArray
from pyproj.crs import ProjectedCRS
from pyproj.crs.coordinate_operation import TransverseMercatorConversion

from companion.cli.output_file import output_file, write_text
from companion.core.geo import LatLon
from mission_tools.bathymetry.cleaning import REASONS
from mission_tools.bathymetry.depth_chart import DepthChart
from mission_tools.bathymetry.planner_map import Shapes, planner_map
from mission_tools.bathymetry.soundings import Floats
from mission_tools.overwrite_guard import CREATOR

STEPS_M: Final = (0.1, 0.2, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
MOST_CONTOURS: Final = 12


def frame_crs(origin: LatLon) -> pyproj.CRS:
    """The frame of a chart for GIS programs: transverse Mercator with scale 1 round its origin."""
    conversion = TransverseMercatorConversion(origin.lat_deg, origin.lon_deg, 0.0, 0.0, 1.0)
    return ProjectedCRS(conversion, name=f"mavboat {origin.lat_deg:.6f} {origin.lon_deg:.6f}")


def contour_levels(deepest_m: float) -> Floats:
    """Round depths, at most MOST_CONTOURS."""
    step = next((step for step in STEPS_M if deepest_m / step <= MOST_CONTOURS), 100.0)
    return np.arange(step, max(deepest_m, 1.5 * step), step)


def contours(chart: DepthChart) -> tuple[Shapes, Floats]:
    """Lines of equal depth in the frame, and the depth of each."""
    surface = chart.surface
    known = np.ma.masked_invalid(surface.depth_m)
    generator = contourpy.contour_generator(*surface.grid.middles, known)
    lines = [
        (shapely.LineString(line), level)
        for level in contour_levels(float(known.max())).tolist()
        for line in generator.lines(level)
        if len(line) > 2
    ]
    return np.array([line for line, _ in lines], dtype=object), np.array([level for _, level in lines])


def write_products(chart: DepthChart, folder: Path) -> dict[str, Any]:
    """Write all files but the pictures; returns the figures. Raises OutputError: one cannot be written."""
    frame = frame_crs(chart.chart.frame.origin)
    to_degrees = pyproj.Transformer.from_crs(frame, "EPSG:4326", always_xy=True)

    def degrees(shapes: Shapes) -> Shapes:
        moved: Shapes = shapely.transform(shapes, lambda at: np.column_stack(to_degrees.transform(*at.T)))
        return moved

    with output_file(folder / "depth.tif") as aside:
        _write_grid(aside, chart, frame)
    lines, levels = contours(chart)
    lines = degrees(lines)
    named = {"name": np.array([f"{level:g} m" for level in levels], dtype=object), "depth_m": levels}
    gaps = degrees(shapely.get_parts(chart.gaps))
    areas = {"area_m2": np.round(shapely.area(shapely.get_parts(chart.gaps)), 1)}
    unknown = degrees(shapely.get_parts(chart.unknown))
    with output_file(folder / "chart.gpkg") as aside:
        place = np.column_stack((chart.at.east_m, chart.at.north_m))
        points = degrees(shapely.points(np.nan_to_num(place)))
        points[~np.isfinite(place).all(axis=1)] = None
        s = chart.soundings
        fields = {
            "depth_m": chart.at.depth_m,
            "reason": np.array(REASONS, dtype=object)[chart.codes],
            "quality": s.quality,
            "unix_s": s.unix_s,
            "position_sd_m": s.position_sd_m,
            "voyage": s.voyage,
        }
        _write(aside, "GPKG", "soundings", "Point", points, fields)
        _write(aside, "GPKG", "contours", "LineString", lines, named)
        _write(aside, "GPKG", "gaps", "Polygon", gaps, areas)
        _write(aside, "GPKG", "not_surveyed", "Polygon", unknown, {})
    for name, driver, kind, shapes, values in (
        ("contours.geojson", "GeoJSON", "LineString", lines, named),
        ("contours.kml", "KML", "LineString", lines, named),
        ("gaps.geojson", "GeoJSON", "Polygon", gaps, areas),
    ):
        with output_file(folder / name) as aside:
            _write(aside, driver, Path(name).stem, kind, shapes, values)
    with output_file(folder / "depth.xyz") as aside:
        east, north = np.meshgrid(*chart.surface.grid.middles)
        known = np.isfinite(chart.surface.depth_m)
        rows = (*to_degrees.transform(east[known], north[known]), chart.surface.depth_m[known])
        table = np.column_stack((*rows, chart.surface.band_m[known]))
        np.savetxt(aside, table, ("%.7f", "%.7f", "%.3f", "%.3f"), header="longitude latitude depth_m band_m")
    write_text(folder / "lake.geojson", json.dumps(planner_map(chart, degrees), ensure_ascii=False) + "\n")
    figures = {"generator": CREATOR, **chart.figures()}
    write_text(folder / "chart.json", json.dumps(figures, indent=1, ensure_ascii=False) + "\n")
    return figures


def _write_grid(path: Path, chart: DepthChart, crs: pyproj.CRS) -> None:
    surface = chart.surface
    rows, columns = surface.depth_m.shape
    cell, west, north = surface.grid.cell_m, surface.grid.west_m, surface.grid.north_m
    transform = rasterio.transform.Affine(cell, 0.0, west, 0.0, -cell, north)
    with rasterio.open(
        path, "w", driver="GTiff", width=columns, height=rows, count=2, dtype="float32", nodata=np.nan,
        crs=rasterio.crs.CRS.from_wkt(crs.to_wkt()), transform=transform, compress="deflate",
    ) as file:  # fmt: skip
        for band, (values, name) in enumerate(
            ((surface.depth_m, "depth below the datum"), (surface.band_m, "half of the 90 % band")), 1
        ):
            file.write(values.astype(np.float32), band)
            file.set_band_description(band, name)
        file.units = ("metre", "metre")


def _write(
    path: Path, driver: str, layer: str, kind: str, shapes: Shapes, fields: dict[str, NDArray[Any]]
) -> None:
    """A layer in degrees; into a GeoPackage beside those that it has."""
    pyogrio.raw.write(
        path, shapely.to_wkb(shapes), list(fields.values()), list(fields), layer=layer, driver=driver,
        geometry_type=kind, crs="EPSG:4326", append=driver == "GPKG" and path.exists(),
    )  # fmt: skip
