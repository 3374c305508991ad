"""Scenario TOML as a planner reads it, and how SOURCE is found."""

import tomllib
from pathlib import Path

import pytest

from companion.core.geo import Point
from mission_tools.errors import MapError, UsageError
from mission_tools.maps import Source, load_source
from mission_tools.maps.scenario import decode_scenario

POND = Path(__file__).parents[3] / "examples" / "maps" / "mill_pond.geojson"
ORIGIN = "[origin]\nlat_deg = 50.0\nlon_deg = -1.2\n"


def decode(text: str, path: Path = Path("x.toml")) -> Source:
    return decode_scenario(tomllib.loads(text), path)


def test_a_pool_in_local_metres_with_its_cases() -> None:
    source = decode(
        "seed = 3\n"
        + ORIGIN
        + """
        [map]
        name = "Pool"
        water = [[-0.05, -0.05], [1.175, -0.05], [1.175, 2.45], [-0.05, 2.45]]
        [[map.obstacles]]
        name = "box"
        polygon = [[0.5, 1.0], [0.7, 1.0], [0.7, 1.2], [0.5, 1.2]]
        [[map.obstacles]]
        name = "drum"
        circle = { centre = [0.3, 0.5], radius_m = 0.1 }
        [route]
        start = [0.1, 0.2]
        goal = { lat_deg = 50.0, lon_deg = -1.2 }
        via = [[0.9, 1.0]]
        clearance_m = 0.06
        heuristic = "euclidean"
        smooth = false
        [[cases]]
        name = "1"
        start = [1.05, 0.28]
        goal = [0.25, 1.75]
        [vessel]
        anything = "of the emulator's"
        """
    )
    assert source.chart.name == "Pool"
    assert source.chart.water.area == pytest.approx(1.225 * 2.5 - 0.04 - 0.0314, abs=2e-4)
    assert (
        source.chart.obstruction(Point(0.5, 0.2001)) == "on drum"
    )  # the drum is not drawn smaller than it is
    assert source.route.start == Point(0.2, 0.1)
    assert source.route.goal == pytest.approx(Point(0.0, 0.0), abs=1e-9)
    assert source.route.via == (Point(1.0, 0.9),)
    assert (source.route.clearance_m, source.route.heuristic, source.route.smooth) == (
        0.06,
        "euclidean",
        False,
    )
    case = source.with_case("1").route
    assert (case.start, case.goal, case.via) == (Point(0.28, 1.05), Point(1.75, 0.25), ())
    with pytest.raises(UsageError, match="no case '9' in Pool: there are 1"):
        source.with_case("9")


def test_a_map_file_lies_beside_the_scenario_and_may_get_more_obstacles() -> None:
    text = f'[map]\nfile = "{POND.name}"\n'
    plain = decode(text, POND.with_name("x.toml")).chart
    more = decode(
        ORIGIN + text + '[[map.obstacles]]\nname="wreck"\npolygon=[[0,100],[4,100],[4,104]]',
        POND.with_name("x.toml"),
    ).chart
    assert plain.name == more.name == "Mill Pond"
    assert more.obstruction(Point(101.0, 3.5)) == "on wreck"
    assert more.navigable.area == pytest.approx(plain.navigable.area - 8.0, abs=0.5)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "origin is missing"),
        ("[origin]\nlat_deg = 91.0\nlon_deg = 0.0", "<= 90.0 - at `$.origin.lat_deg`"),
        (ORIGIN + "[map]\nfiel = 'x'", "unknown field `fiel` - at `$.map`"),
        (ORIGIN + "[route]\nclearance_m = -1.0", "$.route.clearance_m"),
        (ORIGIN + "[route]\nheuristic = 'best'", "$.route.heuristic"),
        (ORIGIN + "[route]\nstart = [1]", "$.route.start"),
        (
            ORIGIN + "[map]\nwater = [[0,0],[1,1],[1,0],[0,1]]",
            "map.water: not a valid polygon: self-intersection at",
        ),
        (ORIGIN + "[map]\nwater = [[0,0],[1,1]]", "$.map.water"),
        (ORIGIN + "[[map.obstacles]]\nname = 'x'", 'map.obstacles[0] "x": expected either polygon or circle'),
        (ORIGIN + "[map]\nfile = 'nowhere.geojson'", "nowhere.geojson: cannot be read"),
        (ORIGIN + "[map]\nfile = 'a'\nwater = [[0,0],[1,1],[1,0]]", "exclude each other"),
    ],
)
def test_a_key_that_cannot_be_used_is_named(text: str, said: str) -> None:
    with pytest.raises(MapError) as caught:
        decode(text)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_source_is_a_name_a_scenario_or_a_map(tmp_path: Path) -> None:
    assert load_source(str(POND)).chart.name == "Mill Pond"
    file = tmp_path / "sea.toml"
    file.write_text(ORIGIN, encoding="utf-8")
    assert load_source(str(file)).chart.is_open
    with pytest.raises(MapError, match="atlantis: no such scenario"):
        load_source("atlantis")
    with pytest.raises(MapError, match=r"gone\.toml: cannot be read"):
        load_source(str(tmp_path / "gone.toml"))
    file.write_text("[origin", encoding="utf-8")
    with pytest.raises(MapError, match=r"sea\.toml: not a TOML file"):
        load_source(str(file))
