"""From an aerial photograph and places on its water to a map.

    traced = trace_photo(Path("pond.jpg"), [LatLon(29.4084, -82.1698)])
    traced.save(Path("pond.geojson"))
    traced.preview(Path("pond_traced.png"))

The photograph needs a world file beside it, or GeoTIFF tags. Holes in the water stay land unless they are to
be filled: a glint of the sun and a rock look alike.
"""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from PIL.PngImagePlugin import PngInfo
from scipy import ndimage

from companion.cli.output_file import output_file, write_text
from companion.core.geo import LatLon
from mission_tools.errors import MapError
from mission_tools.geojson import collection, feature
from mission_tools.maps.chart import Area, Chart, area_of
from mission_tools.maps.formats.georeference import Georeference
from mission_tools.maps.formats.mask import open_picture, pixel_m, traced_area, without_specks
from mission_tools.maps.geojson import parse_geojson
from mission_tools.overwrite_guard import PICTURE_METADATA
from mission_tools.tracing.region import Mask, Pixel, grow

MOST_PIXELS = 4_000_000  # that are looked at; a larger photograph is reduced
EDGE_SMOOTHING = 1.0  # pixels: sigma
SIMPLIFICATION = 0.5  # pixels
PREVIEW_PIXELS = 1600
SHOWN_HOLES = 3
_OUTLINE, _TINT, _SEED = (230, 40, 30), (40, 130, 255), (255, 230, 0)


@dataclass(frozen=True, slots=True)
class TraceSettings:
    """threshold: how unlike the model a colour may be, in standard deviations; None chooses (`region.py`).

    fill_m2: holes up to this area become water. inset_pixels: how far the outline is drawn into the water.
    """

    threshold: float | None = None
    fill_m2: float = 0.0
    inset_pixels: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class TracedWater:
    """The water of a photograph. shape: in degrees; outline and mask in pixels of rgb."""

    name: str
    shape: Area
    outline: Area
    mask: Mask
    rgb: NDArray[np.uint8]
    pixel_m: float
    seeds: tuple[Pixel, ...]
    notes: tuple[str, ...]

    def geojson(self) -> str:
        """The map as GeoJSON."""
        shape = json.loads(shapely.to_geojson(shapely.set_precision(self.shape, 1e-8)))
        properties = {"kind": "water", "name": self.name, "traced_at_m": round(self.pixel_m, 3)}
        water = feature(shape["type"], shape["coordinates"], **properties)
        tree = collection([water], generator="mission-trace")
        return json.dumps(tree, ensure_ascii=False) + "\n"

    def chart(self) -> Chart:
        """The map as a chart to plan on."""
        return parse_geojson(json.loads(self.geojson()), self.name, self.name)

    def save(self, path: Path) -> None:
        """Write the map. Raises OutputError: it cannot be written."""
        write_text(path, self.geojson())

    def preview(self, path: Path) -> None:
        """Draw the outline over the photograph. Raises OutputError: the file cannot be written."""
        tinted = self.rgb.astype(np.float64)
        tinted[self.mask] = 0.7 * tinted[self.mask] + 0.3 * np.array(_TINT)
        picture = Image.fromarray(tinted.astype(np.uint8))
        draw = ImageDraw.Draw(picture)
        for polygon in shapely.get_parts(self.outline):
            for ring in (polygon.exterior, *polygon.interiors):
                draw.line([(x, y) for x, y in ring.coords], fill=_OUTLINE, width=2)
        for column, row in self.seeds:
            draw.ellipse((column - 5, row - 5, column + 5, row + 5), outline=_SEED, width=2)
        picture.thumbnail((PREVIEW_PIXELS, PREVIEW_PIXELS))
        with output_file(path) as aside:
            marks = PngInfo()
            for key, mark in PICTURE_METADATA[".png"].items():
                marks.add_text(key, mark)
            picture.save(aside, pnginfo=marks)


def trace_photo(
    path: Path,
    seeds: Sequence[LatLon],
    land: Sequence[LatLon] = (),
    settings: TraceSettings | None = None,
) -> TracedWater:
    """Trace the water that the seeds lie on. land: places whose like is never water. Raises MapError: the
    photograph cannot be read, nothing says where it lies, a seed is outside of it, or no water grew.
    """
    settings = settings or TraceSettings()
    if not seeds:
        raise MapError(f"{path}: name at least one place on its water")
    picture, georeference = open_picture(path)
    factor = math.ceil(math.sqrt(picture.width * picture.height / MOST_PIXELS))
    rgb = np.asarray(picture.convert("RGB").reduce(factor))
    reference = _reduced(georeference, factor)
    pixels = [_pixel(place, reference, rgb, path) for place in (*seeds, *land)]
    afloat, ashore = pixels[: len(seeds)], pixels[len(seeds) :]
    region = grow(rgb, afloat, ashore, settings.threshold)
    if not region.mask.any():
        raise MapError(f"{path}: no water grew from {_said(seeds)}: name a place on plainer water")
    side_m = pixel_m(reference, shapely.Point(afloat[0]), str(path))
    mask, notes = _filled(region.mask, side_m, settings.fill_m2)
    outline = _outline(mask, settings.inset_pixels)
    if outline.is_empty:
        raise MapError(f"{path}: the water that grew from {_said(seeds)} is only specks of {side_m:.2f} m")
    if mask[[0, -1]].any() or mask[:, [0, -1]].any():
        notes.append("the water reaches the edge of the photograph and ends there")
    drawn_m = settings.inset_pixels * side_m
    notes.append(f"pixels of {side_m:.2f} m; outline drawn {drawn_m:.2f} m into the water")
    notes.append(
        f"colours up to {region.threshold:.2f} standard deviations from the water's: see the preview"
    )
    return TracedWater(
        path.stem,
        area_of(shapely.make_valid(reference.in_degrees(outline, str(path)))),
        outline,
        mask,
        rgb,
        side_m,
        tuple(afloat),
        tuple(notes),
    )


def _reduced(reference: Georeference, factor: int) -> Georeference:
    a, b, c, d, e, f, crs = reference
    return Georeference(a * factor, b * factor, c, d * factor, e * factor, f, crs)


def _pixel(place: LatLon, reference: Georeference, rgb: NDArray[np.uint8], path: Path) -> Pixel:
    column, row = (math.floor(value) for value in reference.pixel_of(place, str(path)))
    if not (0 <= column < rgb.shape[1] and 0 <= row < rgb.shape[0]):
        raise MapError(f"{path}: {_said([place])} is outside of the photograph")
    return column, row


def _said(places: Sequence[LatLon]) -> str:
    return "; ".join(f"{place.lat_deg:.6f},{place.lon_deg:.6f}" for place in places)


def _filled(mask: Mask, side_m: float, fill_m2: float) -> tuple[Mask, list[str]]:
    """Holes up to an area filled; a note on those that stay."""
    labels, count = ndimage.label(ndimage.binary_fill_holes(mask) & ~mask)
    areas_m2 = np.bincount(labels.ravel(), minlength=count + 1)[1:] * side_m**2
    small = np.flatnonzero(areas_m2 <= fill_m2) + 1
    filled: Mask = mask | np.isin(labels, small)
    left = sorted((float(area) for area in areas_m2 if area > fill_m2), reverse=True)
    if not left:
        return filled, []
    shown = ", ".join(f"{area:.0f} m²" for area in left[:SHOWN_HOLES])
    more = f" and {len(left) - SHOWN_HOLES} smaller" if len(left) > SHOWN_HOLES else ""
    return filled, [f"holes in the water are taken as land ({shown}{more}): --fill M2 fills up to an area"]


def _outline(mask: Mask, inset_pixels: float) -> Area:
    smooth = ndimage.gaussian_filter(mask.astype(np.float32), EDGE_SMOOTHING)
    simple = area_of(shapely.make_valid(shapely.simplify(traced_area(smooth, 0.5), SIMPLIFICATION)))
    return without_specks(area_of(simple.buffer(-inset_pixels)))
