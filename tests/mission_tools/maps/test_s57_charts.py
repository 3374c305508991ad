"""S-57 charts: a cell of NOAA read by GDAL, and what each object class is to a boat."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mission_tools.errors import MapError
from mission_tools.maps import load_map
from mission_tools.maps.formats.vector import _properties, is_known, s57_properties
from mission_tools.maps.passable import BoatSize, passable

MAPS = Path(__file__).parents[2] / "vectors" / "maps"
NOAA_CELL = MAPS / "US4MD81M_knapps_narrows.000"


def test_a_cell_of_noaa_is_read_with_its_lists_and_its_bridges_are_told() -> None:
    pytest.importorskip("pyogrio", reason="the extra maps is not installed")
    chart = load_map(NOAA_CELL)
    assert chart.name == "US4MD81M_knapps_narrows"
    assert chart.water.area == pytest.approx(257_000.0, rel=0.02)
    (told,) = (note for note in passable(chart, BoatSize()).notes if "overhead" in note)
    assert told.startswith("3 bridges and cables are overhead, the lowest, bridge, leaves 3.6 m")
    low = passable(chart, BoatSize(air_draught_m=4.0))
    assert [feature.kind for feature in low.features][:3] == ["obstacle", "bridge", "bridge"]


def test_a_list_of_any_length_becomes_text() -> None:
    row = {
        "colour": np.array(["3", "1"], dtype=object),
        "restrn": np.array([7]),
        "status": np.array([]),
        "n": 1.5,
    }
    assert _properties(row) == {"colour": "3,1", "restrn": "7", "n": 1.5}


@pytest.mark.parametrize(
    ("object_class", "row", "kind"),
    [
        ("DEPARE", {"drval1": 2.0}, "water"),
        ("DEPARE", {"drval1": -1.5}, "island"),
        ("DEPARE", {}, "island"),
        ("DRGARE", {"drval1": 5.0}, "water"),
        ("LNDARE", {"objnam": "Isle"}, "island"),
        ("UWTROC", {}, "obstacle"),
        ("SLCONS", {}, "pier"),
        ("CBLOHD", {"verclr": 9.0, "vercsa": 7.5}, "bridge"),
    ],
)
def test_chart_objects_are_water_only_where_the_chart_says_so(
    object_class: str, row: Mapping[str, Any], kind: str
) -> None:
    assert is_known(object_class)
    found = s57_properties(object_class, row)
    assert found["kind"] == kind
    assert found.get("depth_m") == row.get("drval1")
    assert found.get("height_m") == (7.5 if kind == "bridge" else None)
    assert not is_known("LIGHTS")


def test_a_chart_without_depths_is_refused() -> None:
    pytest.importorskip("pyogrio", reason="the extra maps is not installed")
    with pytest.raises(MapError, match="no water in it"):
        load_map(MAPS / "empty_chart.000")
