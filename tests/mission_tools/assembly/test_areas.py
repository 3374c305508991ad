"""Fence and rally points from files: what is read from them, and what is said about those that cannot be."""

import json
from pathlib import Path
from typing import Any

import pytest
from drawn_maps import collection, feature
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.mavwp import MAVFenceLoader

from companion.core.geo import LatLon
from mission_tools.assembly.areas import Areas, load_fence, load_rally, open_areas, parse_areas
from mission_tools.errors import MapError, MissionToolsError, PlanFileError
from mission_tools.mission.mission import (
    Fence,
    FenceCircle,
    FencePolygon,
    Mission,
    MissionItem,
    MissionType,
    Rally,
)
from mission_tools.mission.plan_file import save_mission

RING = [[-1.2, 50.0], [-1.198, 50.0], [-1.198, 50.002], [-1.2, 50.0]]
HOLE = [[-1.1986, 50.0004], [-1.1984, 50.0004], [-1.1984, 50.0006], [-1.1986, 50.0004]]
CORNERS = tuple(LatLon(lat, lon) for lon, lat in RING[:-1])
PLACE = LatLon(50.001, -1.199)
FAR = [[lon + 0.01, lat] for lon, lat in HOLE]
AT = [-1.199, 50.001]


def test_kinds_shapes_and_points_become_what_they_say() -> None:
    tree = collection(
        feature([RING], kind="exclusion"),
        feature(AT, "Point", kind="exclusion", radius_m=12.5),
        feature(AT, "Point", radius_m=0.5),
        feature([-1.199, 50.0015], "Point", kind="return_point"),
        feature([-1.199, 50.0005], "Point", kind="rally"),
        feature([-1.199, 50.0007], "Point"),
    )
    fence, rally, _ = parse_areas(tree, "f")
    assert fence.polygons == (FencePolygon(CORNERS, inclusion=False),)
    assert fence.circles == (FenceCircle(PLACE, 12.5, inclusion=False), FenceCircle(PLACE, 0.5))
    assert fence.return_point == LatLon(50.0015, -1.199)
    assert rally == (Rally(LatLon(50.0005, -1.199)), Rally(LatLon(50.0007, -1.199)))


def test_the_holes_of_an_inclusion_are_kept_out_of() -> None:
    fence, *_ = parse_areas(feature([RING, HOLE]), "f")
    assert [area.inclusion for area in fence.polygons] == [True, False]
    assert fence.polygons[1].corners[0] == LatLon(50.0004, -1.1986)


def test_a_map_is_a_fence_round_its_water_and_its_islands_are_kept_out_of() -> None:
    isle = [[lon + 0.0001, lat] for lon, lat in HOLE]
    tree = collection(
        feature([RING, HOLE], kind="water"),
        feature([isle], kind="island"),
        feature(AT, "Point", kind="landmark"),
    )
    fence, *_ = parse_areas(tree, "f")
    assert [area.inclusion for area in fence.polygons] == [True, False, False]
    with pytest.raises(MapError, match="f: 2 separate pieces of water"):
        parse_areas(collection(*(feature([ring], kind="water") for ring in (HOLE, FAR))), "f")


@pytest.mark.parametrize(
    ("tree", "said"),
    [
        (
            collection(feature([RING], kind="fence")),
            "f: feature 1: kind 'fence' is none of inclusion,",
        ),
        (
            collection(feature([RING]), feature(AT, "Point", kind="inclusion")),
            "feature 2: radius_m is None",
        ),
        (feature(AT, "Point", radius_m=-3), "feature 1: radius_m is -3"),
        (feature([RING], kind="rally"), "a rally is a Point, not 'Polygon'"),
        (feature([RING[:-1]]), "ring 1: not closed: ends at lat 50.0"),
        (feature([RING, HOLE], kind="exclusion"), "an exclusion with a hole"),
        (feature(RING, "LineString"), "geometry is 'LineString'"),
        (collection(*[feature(AT, "Point", kind="return_point")] * 2), "feature 2: a second return_point"),
        ({"type": "Feature"}, "feature 1: no geometry"),
    ],
)
def test_what_cannot_be_used_is_named_by_feature_and_what_was_expected(tree: object, said: str) -> None:
    with pytest.raises(MapError) as told:
        parse_areas(tree, "f")
    assert said in str(told.value)
    assert str(told.value).startswith("f: ")


jsons = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text() | st.just("Polygon") | st.just("Point"),
    lambda inner: (
        st.lists(inner) | st.dictionaries(st.sampled_from(("type", "geometry", "coordinates")), inner)
    ),
)


@given(
    coordinates=jsons,
    geometry=st.sampled_from(("Polygon", "MultiPolygon", "Point")),
    properties=st.dictionaries(st.sampled_from(("kind", "radius_m")), jsons | st.just("exclusion")),
)
def test_any_json_gives_areas_or_an_error_that_names_it(
    coordinates: list[Any], geometry: str, properties: dict[str, Any]
) -> None:
    fence, said = Fence(), "f: "
    rally: tuple[Rally, ...] = ()
    try:
        fence, rally, _ = parse_areas(feature(coordinates, geometry, **properties), "f")
    except MapError as error:
        said = str(error)
    assert said.startswith("f: ")
    assert fence != Fence() or rally or said != "f: "


def test_a_plan_s_fence_and_rally_points_are_taken_without_its_mission(tmp_path: Path) -> None:
    fence = Fence((FencePolygon(CORNERS),), (FenceCircle(PLACE, 20.0, inclusion=False),))
    mission = Mission((MissionItem.at(PLACE),), PLACE, fence=fence, rally=(Rally(PLACE, 3.0),))
    save_mission(mission, tmp_path / "pond.plan")
    name = str(tmp_path / "pond.plan")
    assert load_fence(Path(name)).fence == fence
    assert open_areas(name, name) == Areas(fence, (Rally(PLACE, 3.0),), name)


def test_none_clears_and_nothing_leaves_as_it_is() -> None:
    assert open_areas("none", "none").wire_lists() == {MissionType.FENCE: (), MissionType.RALLY: ()}
    assert open_areas(None, None).wire_lists() == {}
    assert str(open_areas("none", None)) == "no fence areas"


@pytest.mark.parametrize("name", ["missing.geojson", "not.json", "latin.geojson", "empty.geojson", "m.plan"])
def test_a_file_without_a_fence_is_named(tmp_path: Path, name: str) -> None:
    (tmp_path / "not.json").write_text("{")
    (tmp_path / "latin.geojson").write_bytes(b"\xff\xfe")
    (tmp_path / "empty.geojson").write_text(json.dumps(collection()))
    save_mission(Mission((MissionItem.at(PLACE),), PLACE), tmp_path / "m.plan")
    for load in (load_fence, load_rally):
        with pytest.raises(MissionToolsError, match=name) as told:
            load(tmp_path / name)
        assert told.value.exit_code == 2


OLD_FENCE = """40.071308\t-105.229759
40.071434\t-105.229958
40.071224\t-105.229935
40.071228\t-105.229546
40.071449\t-105.229530
40.071434\t-105.229958
"""


@pytest.mark.parametrize("text", [OLD_FENCE, f"#saved by a station\n\n{OLD_FENCE}"])
def test_an_old_fence_of_ardupilot_is_read_as_its_loader_reads_it(tmp_path: Path, text: str) -> None:
    path = tmp_path / "fence.txt"
    path.write_text(text, encoding="utf-8")
    loader = MAVFenceLoader()
    loader.load(str(path))
    fence = load_fence(path).fence
    (polygon,) = fence.polygons
    ours = [(at.lat_deg, at.lon_deg) for at in polygon.corners]
    assert ours == [pytest.approx(at, abs=1e-5) for at in loader.polygon()[:-1]]  # theirs are single floats
    assert polygon.inclusion
    assert fence.return_point == LatLon(40.071308, -105.229759)


def test_an_old_rally_list_of_ardupilot_is_read(tmp_path: Path) -> None:
    path = tmp_path / "rally.txt"
    path.write_text("RALLY 40.071553\t-105.229401\t2.500000\t40.000000\t0.000000\t0\n", encoding="utf-8")
    assert load_rally(path).rally == (Rally(LatLon(40.071553, -105.229401), 2.5),)


def test_a_fence_that_a_station_saved_as_waypoints_is_read(tmp_path: Path) -> None:
    places = [(40.07, -105.2), (40.08, -105.2), (40.08, -105.1)]
    rows = [f"{n}\t0\t0\t5001\t3.0\t0\t0\t0\t{lat}\t{lon}\t0\t0" for n, (lat, lon) in enumerate(places)]
    rows.append("3\t0\t0\t5004\t20.0\t0\t0\t0\t40.075\t-105.15\t0\t0")
    path = tmp_path / "fence.waypoints"
    path.write_text("\n".join(["QGC WPL 110", *rows, ""]), encoding="utf-8")
    fence = load_fence(path).fence
    assert [len(polygon.corners) for polygon in fence.polygons] == [3]
    assert [(circle.radius_m, circle.inclusion) for circle in fence.circles] == [(20.0, False)]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("40.07 -105.2\n40.08 -105.2\n", "2 lines: expected a return point and the corners"),
        ("RALLY 40.07 x 0 0 0 0\n", "line 1: expected latitude and longitude"),
    ],
)
def test_a_broken_list_says_where(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "fence.txt"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(PlanFileError, match=rf"fence\.txt: {said}"):
        load_fence(path)
