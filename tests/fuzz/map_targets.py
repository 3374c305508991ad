"""Map files of any content: each becomes a chart, or is refused in one line that names the file."""

import json
import tempfile
from collections.abc import Callable
from pathlib import Path

from mission_tools.errors import MapError
from mission_tools.maps.assemble import chart_of
from mission_tools.maps.chart import Chart
from mission_tools.maps.formats.gpx import parse_gpx
from mission_tools.maps.formats.kml import parse_kml, unpacked
from mission_tools.maps.formats.mask import read_mask
from mission_tools.maps.geojson import parse_geojson

_WORLD_FILE = "1e-5\n0\n0\n-1e-5\n10\n50\n"


def map_geojson(data: bytes) -> None:
    """GeoJSON."""
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError):
        return
    _read(lambda: parse_geojson(tree, "map", "map"))


def map_kml(data: bytes) -> None:
    """KML; what begins like a zip archive is taken for KMZ."""
    _read(
        lambda: chart_of(parse_kml(unpacked(data, "map") if data.startswith(b"PK") else data, "map", "map"))
    )


def map_gpx(data: bytes) -> None:
    """GPX."""
    _read(lambda: chart_of(parse_gpx(data, "map", "map", lines_are_outlines=True)))


def map_mask(data: bytes) -> None:
    """A PNG or a TIFF with a world file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / ("map.tif" if data[:2] in (b"II", b"MM") else "map.png")
        path.write_bytes(data)
        path.with_suffix(".wld").write_text(_WORLD_FILE, encoding="ascii")
        _read(lambda: chart_of(read_mask(path)), str(path))


def _read(read: Callable[[], Chart], source: str = "map") -> None:
    try:
        chart = read()
    except MapError as error:
        said = str(error)
        assert said.startswith(source), said
        assert "\n" not in said, said
    else:
        assert not chart.navigable.is_empty
        assert chart.navigable.is_valid
