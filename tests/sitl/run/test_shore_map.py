import json

import pytest

from mission_tools.maps.geojson import parse_geojson
from sitl.run.shore import map_of
from sitl.scenarios.scenario import load_scenario


@pytest.mark.parametrize("source", ["lake", "pool", "random"])
def test_the_map_for_the_page_is_the_water_of_the_scenario(source: str) -> None:
    chart = load_scenario(source).chart
    again = parse_geojson(json.loads(map_of(chart)), "map", "map", chart.frame.origin)
    difference = again.navigable.symmetric_difference(chart.navigable)
    assert difference.area < 0.01 * chart.shores.length  # a centimetre: the map's digits
    assert [(feature.kind, feature.name) for feature in again.features if feature.kind != "water"] == [
        (feature.kind, feature.name) for feature in chart.features if feature.kind != "water"
    ]


def test_the_map_of_open_water_has_no_shore() -> None:
    tree = json.loads(map_of(load_scenario("open").chart))
    assert tree == {"type": "FeatureCollection", "name": "open", "features": []}
