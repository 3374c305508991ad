"""Plans over HTTP with the real planner on a real map; what is written is read by the formats' own rules."""

import asyncio
import csv
import io
import json
import re
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
import shapely

from companion.mavlink.items import MissionItem
from mission_tools.shore.plans.plan_service import MOST_BYTES, Sources
from mission_tools.shore.plans.plan_store import MOST_PLANS
from mission_tools.station.messages import Place
from mission_tools.station.outcome import Accepted

sys.path.insert(0, str(Path(__file__).parents[1] / "web"))
from shore_fakes import FakeBoats, Server, run, serving, until

pytestmark = pytest.mark.slow

POND = Path("sitl/scenarios/maps/mill_pond.geojson").resolve()
LAKE = Sources(POND, "lake")
HERE = Place(lat=49.99865, lon=-1.2027)
GOAL = [-1.1975, 50.0017]
ISLE = [[-1.2025, 49.9987], [-1.2010, 49.9987], [-1.2010, 49.9997], [-1.2025, 49.9997]]
NO_FENCE: dict[str, Any] = {"type": "FeatureCollection", "features": []}
GPX = "{http://www.topografix.com/GPX/1/1}"
KML = "{http://www.opengis.net/kml/2.2}"


def prepare(server: Server, **values: Any) -> FakeBoats:  # noqa: ANN401 (fields of a Snapshot)
    """A boat on the pond."""
    server.boats.lists["fence"] = NO_FENCE
    server.boats.change(**({"place": HERE, "cruise_m_s": 2.0} | values))
    return server.boats


async def plan(server: Server, wanted: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    async with server.client.post("/api/boats/1/plan", json=wanted, headers=server.own) as response:
        return response.status, await response.json()


async def read(server: Server, name: str, body: bytes | io.BytesIO) -> tuple[int, dict[str, Any]]:
    path = f"/api/boats/1/plan/import?name={name}"
    async with server.client.post(path, data=body, headers=server.own) as response:
        return response.status, await response.json()


async def get(server: Server, path: str) -> tuple[int, bytes, str]:
    async with server.client.get(path) as response:
        return response.status, await response.read(), response.headers.get("Content-Disposition", "")


def water() -> shapely.Geometry:
    """Of the pond, by shapely's own reader."""
    features = json.loads(POND.read_text("utf-8"))["features"]
    shapes = [(one["properties"].get("kind", "water"), one["geometry"]) for one in features]
    wet = shapely.union_all([shapely.geometry.shape(shape) for kind, shape in shapes if kind == "water"])
    dry = [shapely.geometry.shape(shape) for kind, shape in shapes if kind not in ("water", "landmark")]
    return wet.difference(shapely.union_all(dry))


def in_metres(shape: shapely.Geometry) -> shapely.Geometry:
    """Near enough for an area: a degree is 111.2 km, and cos 50° of it to the east."""
    return shapely.affinity.scale(shape, 71_500.0, 111_200.0, origin=(0, 0))


def test_a_route_keeps_to_the_water_and_says_what_it_costs() -> None:
    async def test() -> None:
        async with serving(sources=LAKE) as server:
            await server.log_in()
            prepare(server)
            status, route = await plan(server, {"task": "route", "goals": [GOAL], "speed_m_s": 1.0})
            assert status == 200
            assert shapely.LineString(route["points"]).within(water())
            assert route["points"][0] == [HERE.lon, HERE.lat]
            assert route["points"][-1] == GOAL
            assert 500 < route["length_m"] < 560
            assert route["time_s"] == pytest.approx(route["length_m"], rel=0.1)
            assert 1 < route["charge_percent"] < 30
            assert (route["fits"], route["has_areas"], route["task"]) == (True, False, "route")
            assert route["clearance_m"] >= 4.0
            assert route["items"] == len(route["points"])  # the speed is one more, home is one less

    run(test())


def test_a_survey_of_an_area_covers_it_and_comes_back() -> None:
    async def test() -> None:
        async with serving(sources=LAKE) as server:
            await server.log_in()
            prepare(server)
            wanted = {"task": "survey", "area": ISLE, "footprint_m": 10, "overlap": 0.2, "return": True}
            status, survey = await plan(server, wanted)
            assert status == 200
            line = shapely.LineString(survey["points"])
            assert line.within(water())
            near = shapely.affinity.scale(
                line, 1.0, 1 / 0.643, origin=(0, 0)
            )  # degrees as long as each other
            lit = near.buffer(5.5 / 71_500)
            wet = shapely.affinity.scale(
                shapely.Polygon(ISLE).intersection(water()), 1.0, 1 / 0.643, origin=(0, 0)
            )
            inner = wet.buffer(-5.0 / 71_500)
            assert lit.intersection(inner).area > 0.97 * inner.area
            assert survey["points"][0] == survey["points"][-1]

    run(test())


def test_a_plan_that_the_battery_does_not_hold_is_planned_and_said_not_to_fit() -> None:
    async def test() -> None:
        async with serving(sources=LAKE) as server:
            await server.log_in()
            prepare(server)
            status, survey = await plan(server, {"task": "survey", "footprint_m": 30, "overlap": 0.2})
            assert status == 200
            assert survey["fits"] is False
            assert survey["charge_percent"] > 90

    run(test())


def test_the_boats_fence_is_kept_to() -> None:
    ring = [
        [-1.2040, 49.9980],
        [-1.1990, 49.9980],
        [-1.1990, 50.0020],
        [-1.2040, 50.0020],
        [-1.2040, 49.9980],
    ]
    geometry = {"type": "Polygon", "coordinates": [ring]}
    feature = {"type": "Feature", "properties": {"seq": 0, "command": 5001}, "geometry": geometry}

    async def test() -> None:
        async with serving(sources=LAKE) as server:
            await server.log_in()
            boats = prepare(server)
            boats.lists["fence"] = {"type": "FeatureCollection", "features": [feature]}
            status, refused = await plan(server, {"task": "route", "goals": [GOAL]})
            assert status == 422
            assert "fence" in refused["error"]
            inside = {"task": "route", "goals": [[-1.1999, 50.0003]]}
            status, route = await plan(server, inside)
            assert status == 200
            assert shapely.LineString(route["points"]).within(shapely.Polygon(ring))
            del boats.lists["fence"]
            status, route = await plan(server, inside)
            assert "does not keep to it" in route["warnings"][0]

    run(test())


def test_without_a_map_routes_are_straight_and_without_a_boat_file_nothing_is_said_of_the_charge() -> None:
    async def test() -> None:
        async with serving() as server:
            await server.log_in()
            prepare(server)
            _, route = await plan(server, {"task": "route", "goals": [GOAL]})
            assert route["points"] == [[HERE.lon, HERE.lat], GOAL]
            assert (route["charge_percent"], route["fits"], route["clearance_m"]) == (None, None, None)
            assert route["time_s"] == pytest.approx(route["length_m"] / 2.0)
            prepare(server, cruise_m_s=None)
            _, route = await plan(server, {"task": "route", "goals": [GOAL]})
            assert route["time_s"] is None

    run(test())


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ({"task": "route", "goals": [[-1.5, 50.0]]}, "lies outside the map"),
        ({"task": "route", "goals": [GOAL], "clearance_m": 300}, "clearance"),
        ({"task": "route", "goals": [[-1.2, 91.0]]}, "goals"),
        ({"task": "route", "goals": [[2.0, 50.0]], "start": {"lat": 0.0, "lon": 0.0}}, "nowhere near"),
        ({"task": "survey", "footprint_m": 5, "area": [[0, 0], [0, 1], [1, 1]]}, ""),
    ],
)
def test_where_there_is_no_plan_the_planners_own_sentence_says_why(wanted: dict[str, Any], said: str) -> None:
    async def test() -> None:
        async with serving(sources=LAKE) as server:
            await server.log_in()
            prepare(server)
            status, refused = await plan(server, wanted)
            assert status == 422
            assert said in refused["error"]
            assert "Traceback" not in refused["error"]
            assert "/tmp/" not in refused["error"]  # noqa: S108 (a message)
            assert "--" not in refused["error"]

    run(test())


def test_a_viewer_may_not_plan_and_an_unplaced_boat_needs_a_start() -> None:
    async def test() -> None:
        async with serving(sources=LAKE) as server:
            prepare(server, place=None)
            assert (await plan(server, {"task": "route", "goals": [GOAL]}))[0] == 403
            assert (await read(server, "x.gpx", b"<gpx/>"))[0] == 403
            await server.log_in()
            status, refused = await plan(server, {"task": "route", "goals": [GOAL]})
            assert (status, refused["key"]) == (422, "planner.no_boat")
            start = {"lat": HERE.lat, "lon": HERE.lon}
            assert (await plan(server, {"task": "route", "goals": [GOAL], "start": start}))[0] == 200

    run(test())


async def files_of(server: Server, path: str) -> dict[str, bytes]:
    """Each format of a plan, saved under a plain name."""
    found = {}
    for kind in ("plan", "waypoints", "kml", "gpx", "geojson"):
        status, body, disposition = await get(server, f"{path}.{kind}")
        assert status == 200, kind
        assert re.fullmatch(rf'attachment; filename="[A-Za-z0-9-]+\.{kind}"', disposition)
        found[kind] = body
    return found


def check_files(files: dict[str, bytes], points: list[list[float]]) -> None:
    """By the rules of the formats, each file has this line."""
    tree = json.loads(files["plan"])
    assert (tree["fileType"], tree["version"], tree["mission"]["version"]) == ("Plan", 1, 2)
    lines = {"plan": [item["params"][5:3:-1] for item in tree["mission"]["items"] if item["command"] == 16]}
    rows = list(csv.reader(files["waypoints"].decode().splitlines()[1:], delimiter="\t"))
    assert [int(row[0]) for row in rows] == list(range(len(rows)))
    lines["waypoints"] = [[float(row[9]), float(row[8])] for row in rows[1:] if row[3] == "16"]
    gpx = ElementTree.fromstring(files["gpx"])  # noqa: S314 (our own)
    assert (gpx.tag, gpx.get("version")) == (f"{GPX}gpx", "1.1")
    route = gpx.findall(f"{GPX}rte/{GPX}rtept")
    lines["gpx"] = [[float(at.attrib["lon"]), float(at.attrib["lat"])] for at in route][1:]
    kml = ElementTree.fromstring(files["kml"])  # noqa: S314 (our own)
    text = kml.findtext(f"{KML}Document/{KML}Placemark/{KML}LineString/{KML}coordinates") or ""
    lines["kml"] = [[float(value) for value in at.split(",")[:2]] for at in text.split()][1:]
    features = json.loads(files["geojson"])["features"]
    lines["geojson"] = next(
        one["geometry"]["coordinates"] for one in features if one["geometry"]["type"] == "LineString"
    )[1:]
    for kind, line in lines.items():
        assert line == [pytest.approx(at, abs=2e-7) for at in points[1:]], kind


def test_a_plan_is_downloaded_in_every_format_and_reads_back_the_same() -> None:
    async def test() -> None:
        async with serving(sources=LAKE) as server:
            await server.log_in()
            prepare(server)
            wanted = {"task": "route", "goals": [GOAL, [-1.1995, 50.0005]], "speed_m_s": 1.5}
            _, route = await plan(server, wanted)
            files = await files_of(server, f"/api/plans/{route['id']}")
            check_files(files, route["points"])
            for kind, body in files.items():
                status, again = await read(server, f"voyage.{kind}", body)
                assert status == 200, again
                assert again["points"] == [pytest.approx(at, abs=2e-7) for at in route["points"]], kind
                assert (again["name"], again["task"]) == ("voyage", "import")
                assert again["length_m"] == pytest.approx(route["length_m"], abs=0.1)

    run(test())


def test_the_mission_on_board_is_downloaded_with_its_fence() -> None:
    points = [[-1.2027, 49.99865], [-1.2, 49.9995], GOAL]
    items = tuple(
        MissionItem(frame=0 if n == 0 else 3, command=16, x=round(lat * 1e7), y=round(lon * 1e7))
        for n, (lon, lat) in enumerate(points)
    )
    ring = [[-1.21, 49.99], [-1.19, 49.99], [-1.19, 50.01], [-1.21, 49.99]]
    fence = {
        "type": "Feature",
        "properties": {"seq": 0, "command": 5001},
        "geometry": {"type": "Polygon", "coordinates": [ring]},
    }

    async def test() -> None:
        async with serving() as server:
            boats = prepare(server)
            assert (await get(server, "/api/boats/1/mission.plan"))[0] == 403
            await server.log_in()
            assert (await get(server, "/api/boats/1/mission.plan"))[0] == 404
            boats.items_on_board = items
            boats.lists["fence"] = {"type": "FeatureCollection", "features": [fence]}
            files = await files_of(server, "/api/boats/1/mission")
            check_files(files, points)
            (area,) = json.loads(files["plan"])["geoFence"]["polygons"]
            assert area["polygon"] == [[pytest.approx(lat), pytest.approx(lon)] for lon, lat in ring[:-1]]

    run(test())


def test_an_imported_route_over_land_is_warned_of() -> None:
    body = (
        b'<gpx xmlns="http://www.topografix.com/GPX/1/1" creator="BaseCamp" version="1.1"><rte>'
        b'<rtept lat="49.9987" lon="-1.2026"/><rtept lat="50.0005" lon="-1.2"/></rte></gpx>'
    )

    async def test() -> None:
        async with serving(sources=LAKE) as server:
            await server.log_in()
            prepare(server)
            status, route = await read(server, "Across%20the%20isle.gpx", body)
            assert status == 200
            assert route["name"] == "Across the isle"
            assert any("crosses land" in warning for warning in route["warnings"])
            assert route["items"] == 2

    run(test())


@pytest.mark.parametrize("kind", ["gpx", "plan"])
def test_an_imported_route_that_leaves_the_boats_fence_is_warned_of(kind: str) -> None:
    ring = [[-1.2040, 49.9980], [-1.2020, 49.9980], [-1.2020, 49.9990], [-1.2040, 49.9980]]
    geometry = {"type": "Polygon", "coordinates": [ring]}
    fence = {"type": "Feature", "properties": {"seq": 0, "command": 5001}, "geometry": geometry}

    async def test() -> None:
        async with serving() as server:
            await server.log_in()
            boats = prepare(server)
            _, route = await plan(server, {"task": "route", "goals": [GOAL]})
            _, body, _ = await get(server, f"/api/plans/{route['id']}.{kind}")
            boats.lists["fence"] = {"type": "FeatureCollection", "features": [fence]}
            status, again = await read(server, f"x.{kind}", body)
            assert status == 200
            assert again["warnings"]
            assert not again["has_areas"]

    run(test())


@pytest.mark.parametrize(
    ("name", "body", "said"),
    [
        ("x.gpx", b'<!DOCTYPE g [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><gpx>&b;</gpx>', "DOCTYPE"),
        ("x.kml", b"<kml><Document/></kml>", "no route"),
        ("x.kml", b"\x00\xff\xfe", "not XML"),
        ("x.kml", b"<kml>" + b"<a>" * 5000, "nested too deep"),
        ("x.geojson", b"[" * 100_000, "not a JSON"),
        ("x.geojson", b'{"type": "Point", "coordinates": [1e400, 2]}', "expected"),
        ("x.plan", b"{}", "not a QGroundControl plan"),
        ("x.waypoints", b"QGC WPL 110\n0\t1", "12 fields"),
        ("..%2F..%2Fetc%2Fpasswd", b"", "name"),
        ("x.exe", b"MZ", "name"),
        ("", b"", "name"),
    ],
)
def test_a_file_that_is_no_plan_is_refused_in_a_sentence(name: str, body: bytes, said: str) -> None:
    async def test() -> None:
        async with serving(sources=LAKE) as server:
            await server.log_in()
            prepare(server)
            status, refused = await read(server, name, body)
            assert status == 422
            assert said in refused["error"]
            assert "\n" not in refused["error"]
            assert "/tmp/" not in refused["error"]  # noqa: S108 (a message)

    run(test())


def test_a_file_may_have_two_megabytes_and_no_more() -> None:
    async def test() -> None:
        async with serving() as server:
            await server.log_in()
            prepare(server)
            assert (await read(server, "x.gpx", io.BytesIO(bytes(MOST_BYTES + 1))))[0] == 413
            assert (await read(server, "x.gpx", io.BytesIO(b" " * MOST_BYTES)))[0] == 422

    run(test())


def test_the_latest_plans_are_kept_and_their_files_go_with_the_server() -> None:
    async def test() -> None:
        async with serving() as server:
            await server.log_in()
            prepare(server)
            rows = ("QGC WPL 110", "0 1 0 16 0 0 0 0 50 -1.2 0 1", "1 0 3 16 0 0 0 0 50.001 -1.2 0 1")
            body = "\n".join(rows).replace(" ", "\t").replace("QGC\tWPL\t", "QGC WPL ").encode()
            plans = [(await read(server, f"p{n}.waypoints", body))[1] for n in range(MOST_PLANS + 1)]
            assert len({one["id"] for one in plans}) == len(plans)
            statuses = [(await get(server, f"/api/plans/{one['id']}.plan"))[0] for one in plans]
            assert statuses == [404] + [200] * MOST_PLANS
            root = server.hub.plans.store.new_folder().parent
            assert len(list(root.iterdir())) == MOST_PLANS + 1
        assert not root.exists()

    run(test())


def test_the_planner_ends_when_the_page_leaves() -> None:
    async def test() -> None:
        async with serving(sources=LAKE) as server:
            await server.log_in()
            prepare(server)
            call = asyncio.create_task(plan(server, {"task": "survey", "footprint_m": 1}))
            planner = server.hub.plans._planner
            await until(lambda: planner._process is not None)
            process = planner._process
            assert process is not None
            call.cancel()
            await asyncio.gather(call, return_exceptions=True)
            await process.wait()
            assert process.returncode == -9
            await until(lambda: planner._asked == 0)

    run(test())


def test_a_plan_is_uploaded_as_it_is_and_areas_only_if_asked_for() -> None:
    tree: dict[str, Any] = {
        "fileType": "Plan",
        "version": 1,
        "mission": {
            "version": 2,
            "plannedHomePosition": [49.99865, -1.2027, 0],
            "items": [
                {"type": "SimpleItem", "command": 178, "frame": 2, "params": [1, 0.7, -1, 0, 0, 0, 0]},
                {
                    "type": "SimpleItem",
                    "command": 16,
                    "frame": 3,
                    "params": [9, 0, 0, None, 49.999, -1.202, 0],
                },
            ],
        },
        "geoFence": {
            "version": 2,
            "polygons": [{"polygon": [[49.99, -1.21], [49.99, -1.19], [50.01, -1.2]], "inclusion": True}],
            "circles": [],
        },
        "rallyPoints": {"version": 2, "points": [[49.9987, -1.2026, 0]]},
    }

    async def test() -> None:
        async with serving() as server:
            await server.log_in()
            boats = prepare(server, armed=False)
            _, given = await read(server, "x.plan", json.dumps(tree).encode())
            assert given["has_areas"]
            live = await server.live()
            for areas, kinds in ((False, ["mission"]), (True, ["fence", "rally", "mission"])):
                request = {"plan": given["id"], "start": True, "with_areas": areas}
                ident = f"u{areas}"
                await live.send_json(
                    {"type": "do", "id": ident, "boat": 1, "what": "upload_plan", "with": request}
                )
                await until(lambda: bool(boats.uploads))
                upload, answered = boats.uploads.pop()
                assert [part.kind for part in upload.parts] == kinds
                assert upload.start is not None
                mission = upload.parts[-1].items
                assert [(one.command, one.param1) for one in mission] == [(16, 0.0), (178, 1.0), (16, 9.0)]
                answered(Accepted("The boat sails the plan"))
                while (told := await live.receive_json())["type"] != "answer":
                    pass
                assert (told["id"], told["ok"], told["result"]) == (ident, True, {"items": 2})
                assert told["text"] == "The boat sails the plan as soon as it is armed"
            await live.close()

    run(test())


@pytest.mark.parametrize(
    "asked", [{}, {"plan": "gone"}, {"plan": 3}, {"plan": "x", "start": "yes"}, {"plan": "x", "y": 1}]
)
def test_an_upload_of_nothing_is_answered(asked: dict[str, Any]) -> None:
    async def test() -> None:
        async with serving() as server:
            await server.log_in()
            live = await server.live()
            await live.send_json({"type": "do", "id": "1", "boat": 1, "what": "upload_plan", "with": asked})
            while (told := await live.receive_json())["type"] != "answer":
                pass
            assert not told["ok"]
            assert told["text"]
            assert server.boats.uploads == []
            await live.close()

    run(test())


def test_the_line_of_a_plan_has_no_place_twice() -> None:
    async def test() -> None:
        async with serving(sources=LAKE) as server:
            await server.log_in()
            prepare(server)
            _, route = await plan(server, {"task": "route", "goals": [GOAL, [-1.1995, 50.0005]]})
            assert all(a != b for a, b in pairwise(route["points"]))

    run(test())


def test_a_place_on_land_is_named_by_its_number() -> None:
    async def test() -> None:
        async with serving(sources=LAKE) as server:
            await server.log_in()
            prepare(server)
            land = [-1.203690, 49.998654]
            for goals, name in (([land, GOAL], "Place 1 "), ([GOAL, GOAL, land], "Place 3 ")):
                status, told = await plan(server, {"task": "route", "goals": goals})
                assert status == 422
                assert told["error"].startswith(name)

    run(test())
