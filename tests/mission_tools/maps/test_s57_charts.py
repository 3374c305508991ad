"""An S-57 chart, its records composed by hand after the standard and read by GDAL.

`empty_chart.000` (header and data set records) is written by GDAL 3.12. Records are those of ISO 8211 with
the fields of S-57 edition 3.1, part 3, section 7; object and attribute codes are of its appendix A.
"""

import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from companion.core.geo import LatLon
from mission_tools.errors import MapError
from mission_tools.maps import load_map
from mission_tools.maps.chart import Chart
from mission_tools.maps.formats.vector import _properties

MAPS = Path(__file__).parents[2] / "vectors" / "maps"
EMPTY = (MAPS / "empty_chart.000").read_bytes()
NOAA_CELL = MAPS / "US4MD81M_knapps_narrows.000"
FIELD_END, UNIT_END = b"\x1e", b"\x1f"
ISOLATED_NODE, CONNECTED_NODE, EDGE, FEATURE = 110, 120, 130, 100
POINT, LINE, AREA = 1, 2, 3
DEPARE, LIGHTS, LNDARE, SLCONS, UWTROC = 42, 75, 71, 122, 153
DRVAL1, OBJNAM = 87, 116
PER_DEG = 10_000_000  # COMF of the empty chart

Corners = Sequence[tuple[float, float]]  # latitude, longitude

LAKE = [(50.0, 10.0), (50.0, 10.004), (50.002, 10.004), (50.002, 10.0)]
ISLE = [(50.0005, 10.001), (50.0005, 10.002), (50.001, 10.002), (50.001, 10.001)]
FLAT = [(50.0, 10.004), (50.0, 10.005), (50.002, 10.005), (50.002, 10.004)]


def record(number: int, *fields: tuple[str, bytes]) -> bytes:
    """An ISO 8211 data record: leader, directory, field area."""
    directory, area = b"", b""
    for tag, data in (("0001", struct.pack("<H", number)), *fields):
        field = data + FIELD_END
        directory += f"{tag}{len(field):05d}{len(area):05d}".encode()
        area += field
    directory += FIELD_END
    base = 24 + len(directory)
    return f"{base + len(area):05d} D     {base:05d}   5504".encode() + directory + area


class ChartFile:
    """A chart in the making."""

    def __init__(self) -> None:
        self.data = EMPTY
        self.count = 2

    def add(self, *fields: tuple[str, bytes]) -> int:
        self.count += 1
        self.data += record(self.count, *fields)
        return self.count

    def vector(self, kind: int, corners: Corners, *ends: bytes) -> bytes:
        """A vector record; returns its name."""
        places = b"".join(struct.pack("<ii", round(y * PER_DEG), round(x * PER_DEG)) for y, x in corners)
        name = struct.pack("<BI", kind, self.count + 1)
        pointers = b"".join(end + struct.pack("<BBBB", 255, 255, n, 255) for n, end in enumerate(ends, 1))
        fields = [("VRID", name + struct.pack("<HB", 1, 1))]
        fields += [("VRPT", pointers)] if ends else []
        self.add(*fields, ("SG2D", places))
        return name

    def feature(self, code: int, shape: int, spatial: Sequence[tuple[bytes, int]], **attributes: str) -> None:
        codes = {"drval1": DRVAL1, "objnam": OBJNAM}
        number = self.count + 1
        said = b"".join(struct.pack("<H", codes[k]) + v.encode() + UNIT_END for k, v in attributes.items())
        fields = [
            ("FRID", struct.pack("<BIBBHHB", FEATURE, number, shape, 1, code, 1, 1)),
            ("FOID", struct.pack("<HIH", 1, number, 1)),
            *([("ATTF", said)] if said else []),
            ("FSPT", b"".join(name + struct.pack("<BBB", 1, usage, 255) for name, usage in spatial)),
        ]
        self.add(*fields)

    def ring(self, corners: Corners) -> bytes:
        """An edge from a connected node back to it."""
        node = self.vector(CONNECTED_NODE, corners[:1])
        return self.vector(EDGE, corners[1:], node, node)

    def area(self, code: int, outer: bytes, *holes: bytes, **attributes: str) -> None:
        self.feature(code, AREA, [(outer, 1), *((hole, 2) for hole in holes)], **attributes)

    def point(self, code: int, at: tuple[float, float]) -> None:
        self.feature(code, POINT, [(self.vector(ISOLATED_NODE, [at]), 255)])


def is_afloat(chart: Chart, lat_deg: float, lon_deg: float) -> bool:
    return chart.clearance_m(chart.frame.to_local(LatLon(lat_deg, lon_deg))) > 0.0


def test_depth_areas_are_water_and_what_dries_land_or_rocks_are_not(tmp_path: Path) -> None:
    pytest.importorskip("pyogrio", reason="the extra maps is not installed")
    file = ChartFile()
    isle = file.ring(ISLE)
    file.area(DEPARE, file.ring(LAKE), isle, drval1="2.5")
    file.area(DEPARE, file.ring(FLAT), drval1="-1.2")
    file.area(LNDARE, isle, objnam="Seal Isle")
    file.point(UWTROC, (50.0015, 10.003))
    file.point(LIGHTS, (50.0015, 10.001))
    path = tmp_path / "XX5TEST.000"
    path.write_bytes(file.data)
    chart = load_map(path)
    assert is_afloat(chart, 50.0002, 10.0005)
    assert is_afloat(chart, 50.0015, 10.001)
    assert not is_afloat(chart, 50.0015, 10.003)
    assert not is_afloat(chart, 50.001, 10.0045)
    at = chart.frame.to_local(LatLon(50.00075, 10.0015))
    assert chart.obstruction(at) == "on Seal Isle"
    assert any("1 other object classes are not used" in note for note in chart.notes)


def test_a_chart_without_depths_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("pyogrio", reason="the extra maps is not installed")
    path = tmp_path / "XX5TEST.000"
    path.write_bytes(EMPTY)
    with pytest.raises(MapError, match="no water in it"):
        load_map(path)


def test_a_cell_of_noaa_is_read_with_its_lists_and_its_bridges_are_told() -> None:
    pytest.importorskip("pyogrio", reason="the extra maps is not installed")
    chart = load_map(NOAA_CELL)
    assert chart.name == "US4MD81M_knapps_narrows"
    assert chart.water.area == pytest.approx(257_000.0, rel=0.02)
    assert any("3 bridges, cables and pipes are overhead" in note for note in chart.notes)
    assert any("the lowest, a bridge, leaves 3.6 m" in note for note in chart.notes)


def test_a_list_of_any_length_becomes_text() -> None:
    row = {
        "colour": np.array(["3", "1"], dtype=object),
        "restrn": np.array([7]),
        "status": np.array([]),
        "n": 1.5,
    }
    assert _properties(row) == {"colour": "3,1", "restrn": "7", "n": 1.5}
