"""What the chart gets of the lists of a boat and of its track."""

import pytest

from companion.mavlink.items import MissionItem
from mission_tools.station.geojson import (
    BoatTrack,
    apart_m,
    command_name,
    fence_geojson,
    mission_geojson,
    rally_geojson,
)
from mission_tools.station.messages import Place

AT = {"x": 500_000_000, "y": -12_000_000}


def test_a_mission_shows_home_radii_and_what_has_no_place() -> None:
    items = (
        MissionItem(frame=0, command=16, param2=5.0, **AT),
        MissionItem(frame=3, command=16, param2=2.0, param3=9.0, **AT),
        MissionItem(frame=3, command=18, param2=9.0, param3=-7.0, **AT),
        MissionItem(frame=2, command=178, param2=0.7, **AT),
        MissionItem(frame=3, command=16, param2=float("inf"), x=0, y=0),
    )
    told = [
        (one["properties"]["name"], one["properties"].get("radius_m"), one["geometry"])
        for one in mission_geojson(items)["features"]
    ]
    point = {"type": "Point", "coordinates": [-1.2, 50.0]}
    assert told == [
        ("home", 5.0, point),
        ("waypoint", 2.0, point),
        ("circle", 7.0, point),
        ("speed", None, None),
        ("waypoint", None, None),
    ]


def corner(north: int, east: int, count: float = 3.0, command: int = 5001) -> MissionItem:
    return MissionItem(frame=0, command=command, param1=count, x=500_000_000 + north, y=-12_000_000 + east)


def test_a_fence_is_drawn_polygon_by_polygon_and_circles_have_their_radius() -> None:
    items = (
        corner(0, 0), corner(100, 0), corner(0, 100),
        MissionItem(frame=0, command=5003, param1=30.0, **AT),
        MissionItem(frame=0, command=5004, param1=-8.0, **AT),
        MissionItem(frame=0, command=5000, param1=4.0, **AT),
        corner(0, 0, command=5002), corner(100, 0), corner(0, 100),
        corner(0, 0, float("nan"), command=5002),
    )  # fmt: skip
    features = fence_geojson(items)["features"]
    told = [
        (one["properties"]["seq"], one["properties"]["name"], one["properties"].get("radius_m"))
        for one in features
    ]
    assert told == [
        (0, "inclusion", None),
        (3, "inclusion", 30.0),
        (4, "exclusion", 8.0),
        (5, "return point", None),
        (6, "exclusion", None),
        (9, "exclusion", None),
    ]
    ring = features[0]["geometry"]["coordinates"][0]
    assert ring == [[-1.2, 50.0], [-1.2, 50.00001], [-1.19999, 50.0], [-1.2, 50.0]]
    assert features[4]["geometry"] is None, "two of its corners are of another kind"
    assert [one["properties"]["seq"] for one in rally_geojson(items)["features"]] == list(range(10))


@pytest.mark.parametrize(
    ("number", "name"),
    [(16, "waypoint"), (5001, "inclusion"), (92, "nav guided enable"), (9999, "command 9999")],
)
def test_a_command_has_a_name_in_plain_words(number: int, name: str) -> None:
    assert command_name(number) == name


def test_a_track_keeps_a_point_a_metre_and_when_full_every_other_one() -> None:
    assert apart_m((179.9999, 60.0), (-179.9999, 60.0)) == pytest.approx(11.12, abs=0.01)
    assert apart_m((0.0, 0.0), (0.003, 0.004)) == pytest.approx(555.97, abs=0.01)
    track = BoatTrack()
    for number in range(4_100):  # 0.7 m each
        track.add(Place(lat=number * 0.7 / 111_195.0, lon=0.0))
    assert len(track.points) == 1001 + 33
    assert track.points[0] == (0.0, 0.0)
    assert apart_m(track.points[0], track.points[1]) == pytest.approx(2.8, abs=0.01)
    assert apart_m(track.points[-2], track.points[-1]) == pytest.approx(2.1, abs=0.01)
