"""KML (OGC 12-007) and KMZ maps, as Google Earth and most drawing programs write them.

Polygons become features. Their kind is, in this order: the extended data `kind`; a line `kind: island` in
the description; the name of a folder around them, such as `islands`; OpenStreetMap tags in the extended data.
A polygon without any of these is water, and land within other water. Lines of KML are geodesics.
"""

import re
import zipfile
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers.expat import ExpatError, ParserCreate

import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from mission_tools.errors import MapError
from mission_tools.geojson import KINDS, position
from mission_tools.maps.geojson import Corners, closed_ring
from mission_tools.maps.raw import MAX_FILE_BYTES, RawFeature, RawMap, read_bytes

KIND_IN_TEXT = re.compile(r"\bkind\s*[:=]\s*([a-z_]+)", re.IGNORECASE)
_SHAPES = ("Polygon", "MultiGeometry", "Point", "LineString", "LinearRing", "Track", "MultiTrack", "Model")


def read_kml(path: Path) -> RawMap:
    """Read a .kml map. Raises MapError: one line that names the file, the placemark and the place."""
    return parse_kml(read_bytes(path), str(path), path.stem)


def read_kmz(path: Path) -> RawMap:
    """Read a .kmz map: its first .kml. Raises MapError: as `read_kml`; one that unpacks to too much."""
    return parse_kml(unpacked(read_bytes(path), str(path)), str(path), path.stem)


def unpacked(archive: bytes, source: str) -> bytes:
    """The first .kml of a zip archive, at most MAX_FILE_BYTES of it. Raises MapError: no archive, none in it,
    encrypted, damaged or too large.
    """
    try:
        with zipfile.ZipFile(BytesIO(archive)) as opened:
            names = [name for name in opened.namelist() if name.lower().endswith(".kml")]
            data = b""
            if names:
                with opened.open(names[0]) as file:
                    data = file.read(MAX_FILE_BYTES + 1)
    except Exception as error:  # of many kinds, where an archive is damaged
        raise MapError(f"{source}: not a KMZ archive that can be read: {str(error)[:80]}") from None
    if not names:
        raise MapError(f"{source}: no .kml in the archive")
    if len(data) > MAX_FILE_BYTES:
        raise MapError(f"{source}: {names[0]} unpacks to more than {MAX_FILE_BYTES // 1_000_000} MB")
    return data


def parse_kml(data: bytes, source: str, fallback_name: str = "") -> RawMap:
    """The features of a KML text. Raises MapError: names the source, the placemark and what was expected."""
    root = parse_xml(data, source)
    if root.tag not in ("kml", "Document", "Folder", "Placemark"):
        raise MapError(f"{source}: not KML: its root is <{root.tag}>")
    notes: list[str] = []
    features = []
    for number, (placemark, folder_kind) in enumerate(_placemarks(root), 1):
        name = text_of(placemark, "name")
        where = f"{source}: placemark {number}" + (f' "{name}"' if name else "")
        properties = _properties(placemark, name, folder_kind)
        shapes = [child for child in placemark if child.tag in _SHAPES]
        if not shapes:
            notes.append(f"{where}: no geometry: skipped")
        features += [
            RawFeature(where, properties, found) for shape in shapes for found in _shapes(shape, where, notes)
        ]
    if next(root.iter("NetworkLink"), None) is not None:
        notes.append(f"{source}: has a NetworkLink, which is not followed")
    title = text_of(root, "Document/name")
    return RawMap(
        source, fallback_name, tuple(features), title, tuple(notes), edges="geodesic", nested="land"
    )


def _placemarks(root: Element) -> Iterator[tuple[Element, str]]:
    """Every placemark with the kind that a folder around it names."""
    pending = [(root, "")]
    while pending:
        element, kind = pending.pop()
        if element.tag == "Placemark":
            yield element, kind
        else:
            kind = _folder_kind(text_of(element, "name")) or kind
            pending += [
                (child, kind)
                for child in reversed(element)
                if child.tag in ("Document", "Folder", "Placemark", "kml")
            ]


def _folder_kind(name: str) -> str:
    word = name.lower().strip().replace(" ", "_").replace("-", "_")
    return next((kind for kind in KINDS if word in (kind, kind + "s")), "")


def _properties(placemark: Element, name: str, folder_kind: str) -> dict[str, str]:
    found = {"name": name} if name else {}
    for entry in placemark.iter("Data"):
        found[entry.get("name", "")] = text_of(entry, "value")
    for entry in placemark.iter("SimpleData"):
        found[entry.get("name", "")] = (entry.text or "").strip()
    in_text = KIND_IN_TEXT.search(text_of(placemark, "description"))
    if "kind" not in found and in_text is not None:
        found["kind"] = in_text[1].lower()
    if "kind" not in found and folder_kind:
        found["kind"] = folder_kind
    if not found.get("kind", "-"):
        del found["kind"]
    return found


def _shapes(shape: Element, where: str, notes: list[str]) -> Iterator[BaseGeometry]:
    """The geometries of an element; the polygons of a MultiGeometry are one multipolygon."""
    if shape.tag == "MultiGeometry":
        inner = [found for child in shape if child.tag in _SHAPES for found in _shapes(child, where, notes)]
        polygons = [found for found in inner if isinstance(found, Polygon)]
        yield from (found for found in inner if not isinstance(found, Polygon))
        if polygons:
            yield polygons[0] if len(polygons) == 1 else MultiPolygon(polygons)
    elif shape.tag == "Polygon":
        polygon = _polygon(shape, where, notes)
        if polygon is not None:
            yield polygon
    elif shape.tag in ("Point", "LineString", "LinearRing"):
        corners = _corners(text_of(shape, "coordinates"), where)
        if not corners:
            notes.append(f"{where}: empty geometry: skipped")
        else:
            yield shapely.Point(corners[0]) if len(corners) == 1 else shapely.LineString(corners)
    else:
        notes.append(f"{where}: a {shape.tag}, which encloses no water: skipped")


def _polygon(shape: Element, where: str, notes: list[str]) -> Polygon | None:
    rings: list[Corners | None] = []
    for path in ("outerBoundaryIs/LinearRing/coordinates", "innerBoundaryIs/LinearRing/coordinates"):
        for element in shape.iterfind(path):
            label = f"{where}, ring {len(rings) + 1}"
            rings.append(closed_ring(_corners(element.text or "", label), label, notes))
    if not rings:
        notes.append(f"{where}: empty geometry: skipped")
        return None
    outer, *holes = rings
    return None if outer is None else Polygon(outer, [hole for hole in holes if hole is not None])


def _corners(text: str, where: str) -> Corners:
    """The longitudes and latitudes of a `coordinates` element."""
    corners = []
    for number, part in enumerate(text.split(), 1):
        try:
            values: list[object] = [float(value) for value in part.split(",")[:2]]
        except ValueError:
            raise MapError(f"{where}, position {number}: '{part[:40]}': expected lon,lat") from None
        corners.append(position(values, f"{where}, position {number}"))
    return corners


MAX_DEPTH = 100


def parse_xml(data: bytes, source: str) -> Element:
    """The root element, tags without namespaces. Raises MapError: not XML, or with a document type."""
    builder = TreeBuilder()
    parser = ParserCreate(namespace_separator="}")
    parser.buffer_text = True
    depth = 0

    def refuse(*_: object) -> None:
        raise MapError(f"{source}: has a document type (<!DOCTYPE): remove it; it is not needed")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > MAX_DEPTH:
            raise MapError(f"{source}: line {parser.CurrentLineNumber}: elements nested too deep")
        builder.start(_local(tag), {_local(name): value for name, value in attributes.items()})

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(_local(tag))

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(data, True)
        return builder.close()
    except ExpatError as error:
        raise MapError(f"{source}: line {error.lineno}: not XML: {str(error).partition(':')[0]}") from None
    except MapError:
        raise
    except (LookupError, ValueError):
        raise MapError(f"{source}: not XML in an encoding that is known") from None


def _local(name: str) -> str:
    return name.rpartition("}")[2]


def text_of(element: Element, path: str) -> str:
    """The text of a descendant; empty if there is none."""
    return (element.findtext(path) or "").strip()
