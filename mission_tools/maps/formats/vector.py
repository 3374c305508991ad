"""Vector maps through GDAL (`pyogrio`, extra `maps`): Shapefile, GeoPackage, FlatGeobuf, OSM, S-57.

Attributes are the features' properties, their names in small letters: `kind`, or else OpenStreetMap tags.
Of an OSM extract, what says nothing about water or land is left out. Of S-57 the object classes count (IHO
S-57, appendix A): depth areas with a known least depth of 0 m or more, and dredged areas, are water; what
dries is land; rocks, wrecks and obstructions are obstacles whatever their depth; what hangs over the water is
a bridge with the least of its clearances.
"""

import math
import re
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely

from companion.cli.program_end import how_to_install
from mission_tools.errors import MapError
from mission_tools.maps.assemble import MOST_FEATURES
from mission_tools.maps.raw import RawFeature, RawMap, read_bytes

NEEDS = f"needs pyogrio, which is not installed: {how_to_install('maps')}"
_OSM = frozenset({".osm", ".pbf"})
_OSM_LAYERS = ("multipolygons", "lines", "points")
_HSTORE = re.compile(r'"((?:[^"\\]|\\.)*)"=>"((?:[^"\\]|\\.)*)"')


class _Layer(NamedTuple):
    name: str
    crs: str | None
    shapes: list[Any]
    properties: list[dict[str, Any]]


def read_vector(path: Path) -> RawMap:
    """The features of all layers of a file that GDAL reads, in WGS 84. Raises MapError: pyogrio is not
    installed, or one line that names the file, the layer and the feature.
    """
    suffix, source = path.suffix.lower(), str(path)
    notes: list[str] = []
    layers = list(_layers(path, source))
    if suffix == ".000":
        layers, found = _of_chart_objects(layers, source)
        notes += found
    features: list[RawFeature] = []
    for layer in layers:
        shapes = _in_degrees(layer, source, notes)
        many = len(layers) > 1
        for number, (shape, properties) in enumerate(zip(shapes, layer.properties, strict=True), 1):
            name = properties.get("name")
            where = f"{source}: {layer.name + ', ' if many else ''}feature {number}"
            where += f' "{name}"' if isinstance(name, str) and name else ""
            if shape is None:
                notes.append(f"{where}: no geometry: skipped")
            else:
                features.append(RawFeature(where, properties, shape))
    unlabelled = "skipped" if suffix in _OSM or suffix == ".000" else "water"
    title = path.stem if suffix == ".000" else ""  # a cell's objects have names of their own
    return RawMap(source, path.stem, tuple(features), title, tuple(notes), unlabelled=unlabelled)  # type: ignore[arg-type]


def _layers(path: Path, source: str) -> Iterator[_Layer]:
    """The layers that have geometries."""
    try:
        import pyogrio  # noqa: PLC0415 (optional, and GDAL takes 0.2 s)
    except ImportError:
        raise MapError(f"{source}: {NEEDS}") from None
    read_bytes(path)  # exists and is not too large
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of GDAL, about layers and attributes that are not used
        try:
            listed = [name for name, geometry in pyogrio.list_layers(path).tolist() if geometry is not None]
            if path.suffix.lower() in _OSM:
                listed = [name for name in _OSM_LAYERS if name in listed]
            for name in listed:
                meta, _, shapes, columns = pyogrio.raw.read(path, layer=name, max_features=MOST_FEATURES)
                fields = [str(field).lower() for field in meta["fields"]]
                rows = zip(*(column.tolist() for column in columns), strict=True) if columns else None
                listed_rows = list(rows) if rows is not None else [()] * len(shapes)
                yield _Layer(
                    str(name),
                    meta["crs"],
                    list(shapely.force_2d(shapely.from_wkb(shapes, on_invalid="fix"))),
                    [_properties(dict(zip(fields, row, strict=True))) for row in listed_rows],
                )
        except (pyogrio.errors.DataSourceError, pyogrio.errors.DataLayerError) as error:
            said = str(error).partition(";")[0].replace("\n", " ")
            raise MapError(f"{source}: GDAL cannot read it: {said[:160]}") from None
        except (pyogrio.errors.FeatureError, pyogrio.errors.GeometryError, shapely.GEOSException) as error:
            raise MapError(f"{source}: a feature cannot be read: {str(error)[:120]}") from None


def _properties(row: Mapping[str, Any]) -> dict[str, Any]:
    """What a row says, without empty fields; the tags in OSM's `other_tags` beside the others.

    A list, which pyogrio returns as an array, becomes text as S-57 writes it: "4,6".
    """
    texts = {key: ",".join(map(str, v)) if isinstance(v, np.ndarray) else v for key, v in row.items()}
    found = {
        key: value
        for key, value in texts.items()
        if value is not None and value != "" and not (isinstance(value, float) and math.isnan(value))
    }
    tags = found.pop("other_tags", "")
    if isinstance(tags, str):
        found |= {key.lower(): value for key, value in _HSTORE.findall(tags)}
    return found


def _in_degrees(layer: _Layer, source: str, notes: list[str]) -> list[Any]:
    """The shapes of a layer in WGS 84; None stays None."""
    given = [shape for shape in layer.shapes if shape is not None]
    if layer.crs is None:
        xy = shapely.get_coordinates(given)
        if len(xy) and not (np.abs(xy) <= (360.0, 90.0)).all():
            raise MapError(
                f"{source}: names no reference system, and {xy[0].tolist()} are no degrees: "
                "add one, as by ogr2ogr -a_srs EPSG:CODE OUT.gpkg IN.shp"
            )
        if given:
            notes.append(f"{source}: names no reference system: taken as WGS 84 degrees")
    else:
        from mission_tools.maps.crs import shapes_to_wgs84  # noqa: PLC0415 (PROJ takes 0.1 s to import)

        moved = iter(shapes_to_wgs84(given, layer.crs, source))
        return [None if shape is None else next(moved) for shape in layer.shapes]
    return layer.shapes


def _of_chart_objects(layers: list[_Layer], source: str) -> tuple[list[_Layer], list[str]]:
    """The layers of S-57 that mean water or something solid, their kinds filled in."""
    kept, ignored = [], []
    for layer in layers:
        if not is_known(layer.name):
            ignored.append(layer.name)
            continue
        rows = [s57_properties(layer.name, row) for row in layer.properties]
        kept.append(layer._replace(properties=rows))
    return kept, [f"{source}: {len(ignored)} other object classes are not used"] if ignored else []


_CLASSES = {  # of S-57, by what they are to a boat
    "island": ("LNDARE",),
    "water": ("DRGARE", "LAKARE", "RIVERS", "CANALS", "DOCARE"),
    "pier": ("SLCONS", "PONTON", "FLODOC", "GATCON", "DAMCON"),
    "obstacle": (
        "BUISGL", "MORFAC", "HULKES", "OBSTRN", "WRECKS", "UWTROC", "PILPNT", "OFSPLF", "FSHFAC", "MARCUL",
    ),
}  # fmt: skip
_OVERHEAD = {"BRIDGE": "bridge", "CBLOHD": "cable", "PIPOHD": "pipe", "CONVYR": "conveyor"}
_CLEARANCES = ("verclr", "verccl", "vercsa")  # m: of a fixed span, a closed one, and a safe one under a cable
_KINDS = {object_class: kind for kind, classes in _CLASSES.items() for object_class in classes}
_DEPTH_AREA = "DEPARE"


def is_known(object_class: str) -> bool:
    """Whether a layer of this object class matters to a route."""
    return object_class == _DEPTH_AREA or object_class in _KINDS or object_class in _OVERHEAD


def s57_properties(object_class: str, row: Mapping[str, Any]) -> dict[str, Any]:
    """The attributes of an object with its kind, its name and its least depth or height."""
    found: dict[str, Any] = {**row, "kind": _KINDS.get(object_class, "")}
    name = row.get("objnam")
    if isinstance(name, str):
        found["name"] = name
    if object_class in (_DEPTH_AREA, "DRGARE"):
        least = row.get("drval1")
        depth_m = float(least) if isinstance(least, int | float) else None
        if object_class == _DEPTH_AREA:
            found["kind"] = "water" if depth_m is not None and depth_m >= 0.0 else "island"
        if depth_m is not None:
            found["depth_m"] = depth_m
    if object_class in _OVERHEAD:
        found = {"name": _OVERHEAD[object_class], **found, "kind": "bridge"}
        heights_m = [float(row[key]) for key in _CLEARANCES if isinstance(row.get(key), int | float)]
        if heights_m:
            found["height_m"] = min(heights_m)
    return found
