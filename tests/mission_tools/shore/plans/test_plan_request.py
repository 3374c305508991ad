"""What a page may ask for, and what is refused before any work."""

import json
from typing import Any

import pytest

from companion.mavlink.items import MissionItem
from mission_tools.shore.plans.files import fence_file, mission_text, rally_file
from mission_tools.shore.plans.plan_request import MOST_CORNERS, MOST_GOALS, PlanRequestError, parse_wish
from mission_tools.station.messages import Place

ROUTE: dict[str, Any] = {"task": "route", "goals": [[-1.2, 50.0]]}
SURVEY: dict[str, Any] = {"task": "survey", "footprint_m": 10}


def test_what_is_not_said_is_left_to_the_planner() -> None:
    wanted = parse_wish(json.dumps(ROUTE).encode())
    assert (wanted.start, wanted.speed_m_s, wanted.clearance_m, wanted.is_return) == (None, None, None, False)
    assert parse_wish(json.dumps(ROUTE | {"return": True}).encode()).is_return
    start = parse_wish(json.dumps(ROUTE | {"start": {"lat": -90.0, "lon": 180.0}}).encode()).start
    assert start == Place(lat=-90.0, lon=180.0)


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ({"task": "fly"}, "task"),
        ({"task": "route"}, "needs a goal"),
        (ROUTE | {"goals": [[-1.2, 50.0]] * (MOST_GOALS + 1)}, "goals"),
        (ROUTE | {"goals": [[-1.2, 91.0]]}, "goals"),
        (ROUTE | {"goals": [[-181.0, 50.0]]}, "goals"),
        (ROUTE | {"goals": [[1e999, 50.0]]}, "JSON"),
        (ROUTE | {"goals": [["1", 50.0]]}, "goals"),
        (ROUTE | {"start": {"lat": 91.0, "lon": 0.0}}, "start"),
        (ROUTE | {"start": {"lat": 0.0, "lon": -181.0}}, "start"),
        (ROUTE | {"clearance_m": -1.0}, "clearance_m"),
        (ROUTE | {"speed_m_s": 0.0}, "speed_m_s"),
        (ROUTE | {"speed_m_s": 50.1}, "speed_m_s"),
        (ROUTE | {"out": "/etc/passwd"}, "out"),
        ({"task": "survey"}, "width"),
        (SURVEY | {"footprint_m": 0.0}, "footprint_m"),
        (SURVEY | {"overlap": 0.91}, "overlap"),
        (SURVEY | {"area": [[0.0, 0.0]] * 2}, "2 corners"),
        (SURVEY | {"area": [[0.0, 0.0]] * (MOST_CORNERS + 1)}, "area"),
        (SURVEY | {"angle_deg": 361.0}, "angle_deg"),
    ],
)
def test_a_bad_wish_is_refused_with_a_sentence_that_names_it(wanted: dict[str, Any], said: str) -> None:
    with pytest.raises(PlanRequestError, match=said) as refused:
        parse_wish(json.dumps(wanted).encode())
    assert refused.value.expected


@pytest.mark.parametrize(
    "body", [b"", b"{", b"[]", b"\xff", b"[" * 5000, b'{"task":"route","goals":[[NaN,1]]}', b"1e999"]
)
def test_what_is_no_wish_is_refused(body: bytes) -> None:
    with pytest.raises(PlanRequestError):
        parse_wish(body)


def feature(command: int, geometry: dict[str, Any] | None, **told: float) -> dict[str, Any]:
    """As the station has it."""
    return {"type": "Feature", "geometry": geometry, "properties": {"command": command, "seq": 0, **told}}


def test_a_fence_is_handed_over_with_its_areas_only() -> None:
    ring = {"type": "Polygon", "coordinates": [[[0, 0], [0, 1], [1, 1], [0, 0]]]}
    point = {"type": "Point", "coordinates": [0.5, 0.5]}
    fence = {
        "features": [
            feature(5001, ring),
            feature(5002, ring),
            feature(5004, point, radius_m=5.0),
            feature(5003, point),
            feature(5000, point),
            feature(5001, None),
        ]
    }
    told = fence_file(fence)
    assert told is not None
    assert [
        (one["properties"]["kind"], one["properties"].get("radius_m")) for one in json.loads(told)["features"]
    ] == [("inclusion", None), ("exclusion", None), ("exclusion", 5.0)]
    assert fence_file({"features": [feature(5000, point)]}) is None
    assert fence_file(None) is None


def test_rally_points_are_handed_over() -> None:
    point = {"type": "Point", "coordinates": [0.5, 0.5]}
    told = rally_file({"features": [feature(5100, point), feature(5100, None)]})
    assert told is not None
    assert [one["properties"]["kind"] for one in json.loads(told)["features"]] == ["rally"]


def test_a_mission_is_written_as_the_mavlink_guide_says() -> None:
    items = (
        MissionItem(frame=0, command=16, x=500000000, y=-12000000),
        MissionItem(frame=2, command=178, param1=1.0, param2=0.5, x=7, y=-3),
        MissionItem(
            frame=3, command=16, param4=float("nan"), x=500010001, y=-11990000, z=2.0, autocontinue=0
        ),
    )
    lines = mission_text(items).decode().splitlines()
    assert lines[0] == "QGC WPL 110"
    rows = [line.split("\t") for line in lines[1:]]
    assert [len(row) for row in rows] == [12, 12, 12]
    assert rows[0][:4] == ["0", "1", "0", "16"]
    assert [float(value) for value in rows[1]] == [1, 0, 2, 178, 1, 0.5, 0, 0, 7, -3, 0, 1]
    assert rows[2][7] == "nan"
    assert rows[2][8:] == ["50.0010001", "-1.1990000", "2.0", "0"]
